//! Short files in the dialects of loggers, spreadsheets and weather services, each with what is read
//! from it or with the message that refuses it. All values are invented.

use super::*;

/// How a file is read: the column of times and that of temperatures, if they are named, its unit,
/// and whether bad lines may be left out. The zone is UTC.
#[derive(Clone, Copy, Default)]
struct Asked {
    time: Option<&'static str>,
    column: Option<&'static str>,
    unit: Option<&'static str>,
    no_zone: bool,
    skip_bad: bool,
    missing: Option<&'static str>,
}

fn read_as(asked: Asked, bytes: &[u8]) -> Result<Table, DataError> {
    let layout = Layout {
        time: asked.time.map(String::from),
        zone: (!asked.no_zone).then(|| "UTC".into()),
        skip_bad: asked.skip_bad,
        missing: asked.missing.map(String::from).into_iter().collect(),
        wording: Wording::Flag,
        ..Layout::default()
    };
    let wanted = Wanted::of(ColumnQuantity::Temperature, asked.column, asked.unit);
    parse("t.csv", bytes, &layout, &[wanted])
}

const PLAIN: Asked = Asked {
    time: None,
    column: None,
    unit: None,
    no_zone: false,
    skip_bad: false,
    missing: None,
};

fn column(column: &'static str) -> Asked {
    Asked {
        column: Some(column),
        ..PLAIN
    }
}

fn timed(time: &'static str, name: &'static str) -> Asked {
    Asked {
        time: Some(time),
        ..column(name)
    }
}

fn skipping(asked: Asked) -> Asked {
    Asked {
        skip_bad: true,
        ..asked
    }
}

/// Each file begins on 4 March 2023 at 05:00 UTC with 12 degrees, and has 13.5 an hour later.
#[test]
fn dialects_of_loggers_and_services_are_read() {
    let arrays = "\"TOA5\",\"b\",\"CR6\",\"1\"\n\"TIMESTAMP\",\"RECORD\",\"TC_Avg(1)\",\"TC_Avg(2)\"\n\
        \"TS\",\"RN\",\"degC\",\"degC\"\n\"\",\"\",\"Avg\",\"Avg\"\n\"2023-03-04 05:00:00.05\",1,3.0,12\n\"2023-03-04 06:00:00.05\",2,3.1,13.5\n";
    let serial = "Pier 3,Time,Celsius(\u{b0}C),Humidity(%rh),Serial Number\r\n1,04/03/2023 05:00:00,12,60,000000001\r\n\
        2,04/03/2023 06:00:00,13.5,61\r\n3,14/03/2023 06:00:00,13.5,61\r\n";
    let knmi = "# KNMI\n# STN,YYYYMMDD,   HH,    T,   TD\n  260,20230304,    5,  120,   30\n  260,20230304,    6,  135,   30\n";
    let davis = "\t\tTemp\tHi\tLow\t\nDate\tTime\tOut\tTemp\tTemp\tRain\n04/03/23\t5:00a\t12.0\t12.1\t11.9\t0\n04/03/23\t6:00a\t13.5\t13.6\t13.2\t0\n\
        04/03/23\t7:00p\t14\t14\t14\t0\n05/03/23\t12:00a\t14\t14\t14\t0\n17/03/23\t12:00p\t14\t14\t14\t0\n";
    let parts = "year,month,day,hour,temperature\n2023,3,4,5,12\n2023,3,4,6,13.5\n";
    let buoy = "#YY  MM DD hh mm\n"
        .replace("  ", ",")
        .replace(' ', ",")
        .replace("mm", "mm,temp");
    let buoy = format!("{buoy}#yr,mo,dy,hr,mn,degC\n2023,03,04,05,00,12\n2023,03,04,06,00,13.5\n");
    let repeated =
        "time;temp\n;degC\n2023-03-04 05:00;12\ntime;temp\n;degC\n2023-03-04 06:00;13,5\n";
    let footer = "time,temp\n2023-03-04 05:00,12\n2023-03-04 06:00,13.5\n2023-03-04 07:00,13.5\nEnd of record\nMaximum: 13.5\n";
    let cut = "time,temp,rh\n2023-03-04 05:00,12,60\n2023-03-04 06:00,13.5,61\n2023-03-04 07:00,1";
    let quote =
        "time,temp,note\n2023-03-04 05:00,12,a\n2023-03-04 05:30,14,\"b\n2023-03-04 06:00,13.5,c\n";
    let tenths = Asked {
        unit: Some("0.1degC"),
        ..timed("YYYYMMDD,HH", "T")
    };
    for (what, text, asked) in [
        ("arrays of a Campbell logger", arrays, column("TC_Avg(2)")),
        (
            "a serial number in the first row",
            serial,
            column("Celsius(\u{b0}C)"),
        ),
        ("KNMI, names in a comment", knmi, tenths),
        (
            "usual names of date and hour",
            knmi,
            Asked {
                time: None,
                ..tenths
            },
        ),
        ("Davis, names in two lines", davis, PLAIN),
        ("year, month, day, hour", parts, PLAIN),
        (
            "the same, named",
            parts,
            timed("year,month,day,hour", "temperature"),
        ),
        ("a buoy with minutes below mm", &buoy, PLAIN),
        (
            "date and hour without names",
            "2023-03-04,5,12.0,7\n2023-03-04,6,13.5,7\n",
            timed("1,2", "3"),
        ),
        (
            "hours of two digits, decimal commas",
            "Date;HH;temp\n04.03.2023;05;12\n04.03.2023;06;13,5\n31.03.2023;06;13,5\n",
            PLAIN,
        ),
        (
            "an hour as in 0530",
            "Date;Time;temp\n2023-03-04;0500;12\n2023-03-04;0600;13.5\n",
            PLAIN,
        ),
        (
            "an hour as in 500",
            "Date;Time;temp\n2023-03-04;500;12\n2023-03-04;600;13.5\n2023-03-04;2400;13.5\n",
            PLAIN,
        ),
        (
            "cells with a unit",
            "time,temp\n04 Mar 2023 05:00:00,12.0 degC\n04 Mar 2023 06:00:00,13.5\u{b0}C\n",
            PLAIN,
        ),
        (
            "cells in Fahrenheit",
            "time,temp\n2023-03-04 05:00,53.6 \u{b0}F\n2023-03-04 06:00,56.3 \u{b0}F\n",
            PLAIN,
        ),
        (
            "days of MATLAB",
            "datenum,temp\n738949.208333333,12\n738949.25,13.5\n",
            timed("datenum", "temp"),
        ),
        (
            "Julian dates",
            "jd,temp\n2460007.70833333333,12\n2460007.75,13.5\n",
            timed("jd", "temp"),
        ),
        (
            "days of a spreadsheet",
            "time,temp\n44989.2083333333,12\n44989.25,13.5\n",
            PLAIN,
        ),
        ("repeated headers and units", repeated, PLAIN),
        ("a footer", footer, skipping(PLAIN)),
        ("a last line that was cut off", cut, skipping(PLAIN)),
        ("an unclosed quotation mark", quote, skipping(PLAIN)),
        (
            "a byte-order mark, tabs and pm",
            "\u{feff}Date\tTime\tTemp\n3/4/2023\t5:00 AM\t12\n3/4/2023\t6:00 AM\t13.5\n3/14/2023\t1:00 PM\t13.5\n",
            PLAIN,
        ),
        (
            "names after a tab",
            "\ttime\ttemp\n1\t2023-03-04 05:00\t12\n2\t2023-03-04 06:00\t13.5\n",
            PLAIN,
        ),
        (
            "names in quotation marks",
            "\"Date Time, GMT+01:00\",\"Temp, \u{b0}C\"\n03/04/23 06:00:00 AM,12\n03/04/23 07:00:00 AM,13.5\n03/14/23 06:00:00 AM,12\n",
            PLAIN,
        ),
        (
            "a mark with a decimal comma",
            "time;temp\n2023-03-04 05:00;12\n2023-03-04 05:30;-999,9\n2023-03-04 06:00;13,5\n",
            Asked {
                missing: Some("-999,9"),
                ..PLAIN
            },
        ),
        (
            "-999 without a unit",
            "time;temp\n2023-03-04 05:00;12\n2023-03-04 05:30;-999.0\n2023-03-04 06:00;13.5\n",
            PLAIN,
        ),
    ] {
        let table =
            read_as(asked, text.as_bytes()).unwrap_or_else(|error| panic!("{what}: {error}"));
        let start = table
            .start
            .map(|start| start.to_string())
            .unwrap_or_default();
        assert!(start.starts_with("2023-03-04T05:00:00"), "{what}: {start}");
        let column = &table.columns[0];
        assert!(
            (column.times[1] - 3600.0).abs() < 0.1,
            "{what}: {:?}",
            column.times
        );
        let off = (column.values[0] - 12.0).abs() + (column.values[1] - 13.5).abs();
        assert!(off < 1e-9, "{what}: {:?}", column.values);
    }
}

#[test]
fn what_was_left_out_is_counted() {
    let head = "time,temp\n2023-03-04 05:00,12\n2023-03-04 06:00,13.5\n2023-03-04 07:00,13\n2023-03-04 08:00,12\n";
    for (rest, says) in [
        (
            "End\nMaximum\n",
            "left out 2 lines that cannot be read, the first in line 6",
        ),
        (
            "2023-03-04 09:00,warm\n",
            "left out 1 line that cannot be read, the first in line 6",
        ),
        (
            "2023-03-04 09:00,-999\n",
            "treated 1 value below absolute zero as missing in `temp`",
        ),
        (
            "time,temp\n2023-03-04 09:00,12\n",
            "left out 1 repeated header",
        ),
    ] {
        let said = read_as(skipping(PLAIN), format!("{head}{rest}").as_bytes()).unwrap();
        let said = said.repairs.sentences();
        assert!(said.iter().any(|said| said == says), "{said:?}");
    }
    // Many bad lines are no exceptions.
    let bad = "2023-03-04 09:00 h,1\n".repeat(5);
    let error = read_as(skipping(PLAIN), format!("{head}{bad}").as_bytes()).unwrap_err();
    assert!(
        error.line == Some(6) && error.problem.contains("not a known time"),
        "{error}"
    );
}

/// Each message names the line, what was found, and what to do.
#[test]
fn what_cannot_be_read_is_refused_with_a_remedy() {
    let no_zone = Asked {
        no_zone: true,
        ..timed("datenum", "temp")
    };
    let head = "time,temp\n2023-03-04 05:00,12\n";
    let units = "TIMESTAMP,Batt,PTemp_C,Probe_2,Probe_1\nTS,Volts,degC,mm,degC\n2023-03-04 05:00,12,1,2,3\n2023-03-04 06:00,12,1,2,3\n";
    let dwd = "STATIONS_ID;MESS_DATUM;QN_9;TT_TU;RF_TU;eor\n 1420;2023030400;3;12.0;70.0;eor\n 1420;2023030401;3;12.0;70.0;eor\n";
    let lascar = "Pier,Time,Dew Point(\u{b0}C),Celsius(\u{b0}C),Serial Number\n1,14/03/2023 00:00,7.0,12.0,1\n2,14/03/2023 00:30,7.0,12.0\n";
    for (text, asked, line, says, remedy) in [
        (
            "datenum,temp\n738949.0,12\n738949.1,13\n",
            no_zone,
            Some(2),
            "may be a MATLAB date number, 2023-03-04T00:00:00",
            "--zone UTC",
        ),
        (
            dwd,
            PLAIN,
            None,
            "no column is called `time`",
            "--time MESS_DATUM`",
        ),
        (
            dwd,
            timed("MESS_DATUM", "TT"),
            None,
            "no column is called `TT`",
            "--temperature TT_TU`",
        ),
        (
            lascar,
            PLAIN,
            None,
            "no column has a name",
            "--temperature 'Celsius(\u{b0}C)'`",
        ),
        (
            units,
            PLAIN,
            None,
            "no column has a name",
            "--temperature Probe_1`",
        ),
        (
            "2023-03-04,5,12.0,7\n2023-03-04,6,13.5,7\n",
            PLAIN,
            Some(1),
            "not the names of the columns",
            "--time 1,2` and `--temperature 3",
        ),
        (
            "# STN,YYYYMMDD,HH,T,TD\n 260,20230304,5,120,30\n 260,20230304,6,135,30\n",
            PLAIN,
            Some(1),
            "no column has a name",
            "--temperature T`",
        ),
        (
            "When,Temp 1,Temp 2\n2023-03-04 05:00,12,13\n",
            timed("Wenn", "Temp 1"),
            None,
            "no column is called `Wenn`",
            "--time When`",
        ),
        (
            "station,YYYYMMDD,HH,it's\n260,20230304,1,13\n",
            timed("x", "y"),
            None,
            "no column is called `x`",
            "--time YYYYMMDD,HH`",
        ),
        (
            "station,time,it's\n260,2023-03-04 05:00,13\n",
            PLAIN,
            None,
            "no column has a name",
            r"--temperature 'it'\''s'`",
        ),
        (
            "time,Dew Point Temp,Temp\n2023-03-04 05:00,13,12\n",
            column("x"),
            None,
            "no column is called `x`",
            "--temperature Temp`",
        ),
        (
            &format!("{head}Maximum: 13\n"),
            PLAIN,
            Some(3),
            "1 cell, but the header names 2",
            "leave out bad lines with `--skip-bad`",
        ),
        (
            &format!("{head}yesterday,13\n"),
            PLAIN,
            Some(3),
            "`time` = \"yesterday\" is not a known time",
            "--skip-bad",
        ),
        (
            &format!("{head}2023-03-04 06:00,warm\n"),
            PLAIN,
            Some(3),
            "`temp` = \"warm\" is not a number",
            "--missing warm",
        ),
        (
            "time,temp,rh\n2023-03-04 05:00,12,1\n2023-03-04 06:00,12,1\n2023-03-04 07:00,1",
            PLAIN,
            Some(4),
            "2 cells, but",
            "truncated line",
        ),
        (
            "time,temp\n2023-03-04 05:00,12 \u{b0}C\n2023-03-04 06:00,56 \u{b0}F\n",
            PLAIN,
            Some(3),
            "a different unit from its column",
            "the same unit",
        ),
        (
            "Date,HH,temp\n2023-03-04,5,12\n2023-03-04,25,12\n",
            PLAIN,
            Some(3),
            "`Date,HH` = \"2023-03-04,25\" is not a date and a time",
            "rename the columns",
        ),
        (
            "year,month,day,hour,temp\n2023,2,28,5,12\n2023,2,30,5,12\n",
            PLAIN,
            Some(3),
            "not a known time",
            "--skip-bad",
        ),
    ] {
        let error = read_as(asked, text.as_bytes()).expect_err(text);
        assert_eq!(error.line, line, "{error}");
        assert!(
            error.problem.contains(says) || error.to_string().contains(says),
            "{error}"
        );
        assert!(error.remedy.contains(remedy), "{error}");
    }
    // A column and the zone are asked for at once.
    let asked = Asked {
        no_zone: true,
        ..PLAIN
    };
    let error = read_as(asked, b"time,T\n2023-03-04 05:00,12\n")
        .unwrap_err()
        .to_string();
    let both = [
        "no column has a name",
        "is the date 2023-03-04T05:00:00 without a zone",
        "--zone UTC",
    ];
    assert!(both.iter().all(|part| error.contains(part)), "{error}");
    let huge = format!("{head}2023-03-04 06:00,{}\n", "9".repeat(1_000_000));
    let error = read_as(PLAIN, huge.as_bytes()).unwrap_err().to_string();
    assert!(error.len() < 300 && error.contains("not finite"), "{error}");
    let nul = format!(
        "{head}{}2023-03-04 06:00,1\0\n",
        "2023-03-04 05:00,12\n".repeat(40)
    );
    assert!(
        read_as(PLAIN, nul.as_bytes())
            .unwrap_err()
            .problem
            .contains("not a number")
    );
    for (bytes, says) in [
        (&b"\x1f\x8b\x08\x00x"[..], "compressed"),
        (b" \n\n", "empty"),
    ] {
        let error = read_as(PLAIN, bytes).unwrap_err();
        assert!(error.problem.contains(says), "{error}");
    }
}

/// `time` and `dates` of the data apply to the file of temperatures only where they fit, and files
/// without a common day are refused with both ranges.
#[test]
fn the_other_file_may_have_usual_names_and_date_order() {
    let sensor = "Zeitpunkt,displacement_mm\n4/3/2023 05:00,1\n4/3/2023 06:00,2\n";
    let source = |wording| ColumnSource {
        layout: Layout {
            time: Some("Zeitpunkt".into()),
            zone: Some("UTC".into()),
            dates: Some(DateOrder::DayMonthYear),
            wording,
            ..Layout::default()
        },
        ..ColumnSource::default()
    };
    let read = |air: &str| {
        BearingData::read(
            Origin::Text("z.csv", sensor),
            Some(Origin::Text("t.csv", air)),
            &source(Wording::TemperatureFlag),
            &source(Wording::Flag),
        )
    };
    for air in [
        "TIMESTAMP,temp\n3/4/2023 05:00,1\n3/14/2023 06:00,2\n",
        "Zeitpunkt,temp\n3/4/2023 05:00,1\n3/14/2023 06:00,2\n",
        "time,temp\n2023-03-04T05:00,1\n2023-03-14T06:00,2\n",
        "time,temp\n4/3/2023 05:00,1\n14/3/2023 06:00,2\n",
    ] {
        let data = read(air).unwrap_or_else(|error| panic!("{air}: {error}"));
        assert_eq!(data.displacement.times, [0.0, 3600.0], "{air}");
        assert_eq!(data.temperature.times, [0.0, 867_600.0], "{air}");
    }
    let error = read("Wann,temp\n2023-03-04 05:00,1\n2023-03-14 06:00,2\n").unwrap_err();
    assert!(
        error.remedy.contains("`--temperature-time Wann`"),
        "{error}"
    );
    let error = read("time,temp\n2022-03-04 05:00,1\n2022-03-14 06:00,2\n").unwrap_err();
    let says = "its temperatures, from 2022-03-04T05:00:00Z to 2022-03-14T06:00:00Z, have no time in common with the \
        displacements, from 2023-03-04T05:00:00Z to 2023-03-04T06:00:00Z";
    assert_eq!(error.problem, says);
}
