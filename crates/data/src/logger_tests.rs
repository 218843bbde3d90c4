//! Files as loggers, spreadsheets and weather services write them.

use super::*;
use proptest::prelude::*;

const HOUR: f64 = 3600.0;

fn layout(zone: &str) -> Layout {
    Layout {
        zone: Some(zone.into()).filter(|zone: &String| !zone.is_empty()),
        wording: Wording::Flag,
        ..Layout::default()
    }
}

fn read_as(layout: &Layout, text: &[u8]) -> Result<Table, DataError> {
    parse(
        "t.csv",
        text,
        layout,
        &[Wanted::of(ColumnQuantity::Temperature, None, None)],
    )
}

/// The start and the times of a file with these cells in a column, all in UTC.
fn times(
    column: &str,
    cells: &[&str],
    layout: &Layout,
) -> Result<(Option<String>, Vec<f64>), DataError> {
    let rows: String = cells
        .iter()
        .enumerate()
        .map(|(i, cell)| format!("{cell};{i}\n"))
        .collect();
    let table = read_as(
        layout,
        format!("{column};temperature_degC\n{rows}").as_bytes(),
    )?;
    Ok((
        table.start.map(|start| start.to_string()),
        table.columns[0].times.clone(),
    ))
}

/// Each text is one hour later than the one before it, and the first is this instant.
#[test]
fn dates_are_read_as_they_are_written() {
    let (noon, utc) = ("2025-01-19T12:00:00Z", layout("UTC"));
    let ordered = |word: &str| Layout {
        dates: DateOrder::from_word(word),
        ..layout("UTC")
    };
    for (column, cells, layout, start) in [
        ("time", ["2025-01-19 12:00", "2025-01-19T13:00"], &utc, noon),
        (
            "time",
            ["2025/01/19 12:00", "2025/01/19 13:00:00"],
            &utc,
            noon,
        ),
        (
            "time",
            ["2025-1-9 0:00", "2025-1-9 1:00"],
            &utc,
            "2025-01-09T00:00:00Z",
        ),
        ("time", ["2025.01.19 12:00", "2025.01.19 13:00"], &utc, noon),
        (
            "time",
            ["2025-01-19 12:00 UTC", "2025-01-19 13:00 GMT"],
            &layout(""),
            noon,
        ),
        (
            "time",
            ["2025-01-19 12:00 UTC+0", "2025-01-19 14:00 +0100"],
            &layout(""),
            noon,
        ),
        (
            "time",
            ["2025-01-19 23:00", "2025-01-19 24:00"],
            &utc,
            "2025-01-19T23:00:00Z",
        ),
        ("time", ["19.01.2025 12:00", "19.01.2025 13:00"], &utc, noon),
        (
            "time",
            ["19/01/25 23:30", "20/01/25 00:30"],
            &utc,
            "2025-01-19T23:30:00Z",
        ),
        (
            "time",
            ["25/01/19 23:30", "25/01/20 00:30"],
            &utc,
            "2025-01-19T23:30:00Z",
        ),
        (
            "time",
            ["11/11/2025 12:00", "11/11/2025 13:00"],
            &utc,
            "2025-11-11T12:00:00Z",
        ),
        (
            "time",
            ["1/19/2025 12:00 PM", "1/19/2025 1:00 pm"],
            &utc,
            noon,
        ),
        (
            "time",
            ["01/19/25 12:00:00 AM", "01/19/25 01:00:00 AM"],
            &utc,
            "2025-01-19T00:00:00Z",
        ),
        (
            "time",
            ["9.1.2025 12:00", "9.1.2025 13:00"],
            &ordered("dmy"),
            "2025-01-09T12:00:00Z",
        ),
        (
            "time",
            ["1/9/2025 12:00", "1/9/2025 13:00"],
            &ordered("mdy"),
            "2025-01-09T12:00:00Z",
        ),
        (
            "time",
            ["25-01-09 12:00", "25-01-09 13:00"],
            &ordered("ymd"),
            "2025-01-09T12:00:00Z",
        ),
        (
            "time",
            ["19-Jan-2025 12:00", "19-Jan-2025 13:00"],
            &utc,
            noon,
        ),
        (
            "time",
            ["19 January 2025 12:00", "19 January 2025 13:00"],
            &utc,
            noon,
        ),
        ("time", ["2025011912", "2025011913"], &utc, noon),
        (
            "time",
            ["20250119T120000Z", "20250119T130000Z"],
            &layout(""),
            noon,
        ),
        ("time", ["20250119T1200", "20250119T1300"], &utc, noon),
        (
            "time",
            ["2025-01-19 13:00 CET", "2025-01-19 14:00 MEZ"],
            &layout(""),
            noon,
        ),
        (
            "time",
            ["2025-07-19T14:00:00 MESZ", "2025-07-19T15:00:00 CEST"],
            &layout(""),
            "2025-07-19T12:00:00Z",
        ),
        (
            "Date-Time (EST)",
            ["2025-01-19 07:00", "2025-01-19 08:00"],
            &layout(""),
            noon,
        ),
        (
            "Time (CET)",
            ["2025-07-19 14:00", "2025-07-19 15:00"],
            &layout("Europe/Berlin"),
            "2025-07-19T12:00:00Z",
        ),
        (
            "time",
            ["19. Jan. 2025 12:00", "19. Jan. 2025 13:00"],
            &utc,
            noon,
        ),
        (
            "time",
            ["19. M\u{e4}rz 2025 12:00", "19. M\u{e4}rz 2025 13:00"],
            &utc,
            "2025-03-19T12:00:00Z",
        ),
        (
            "time",
            ["19-Dez-2025 12:00", "19-Dez-2025 13:00"],
            &utc,
            "2025-12-19T12:00:00Z",
        ),
        (
            "time",
            ["19 juillet 2025 12:00", "19 juil. 2025 13:00"],
            &utc,
            "2025-07-19T12:00:00Z",
        ),
        ("time", ["202501191200", "202501191300"], &utc, noon),
        ("time", ["20250119120000", "20250119130000"], &utc, noon),
        (
            "time",
            ["2025011923", "2025011924"],
            &utc,
            "2025-01-19T23:00:00Z",
        ),
        ("time", ["1737288000", "1737291600"], &layout(""), noon),
        (
            "time",
            ["1737288000000", "1737291600000"],
            &layout(""),
            noon,
        ),
        ("time", ["1737288000000000", "1737291600000000"], &utc, noon),
        ("time", ["45676.5", "45676.5416667"], &utc, noon),
        ("time", ["45676,5", "45676,5416667"], &utc, noon),
        (
            "Date Time, GMT+01:00",
            ["01/19/25 01:00:00 PM", "01/19/25 02:00:00 PM"],
            &layout(""),
            noon,
        ),
        (
            "Date Time, GMT -0700",
            ["01/19/25 05:00:00 AM", "01/19/25 06:00:00 AM"],
            &layout(""),
            noon,
        ),
        (
            "Date Time, GMT-03:30",
            ["01/19/25 08:30:00 AM", "01/19/25 09:30:00 AM"],
            &layout(""),
            noon,
        ),
        (
            "Date Time, GMT+05:45",
            ["01/19/25 05:45:00 PM", "01/19/25 06:45:00 PM"],
            &layout(""),
            noon,
        ),
        (
            "time UTC -07:00",
            ["2025-01-19 05:00", "2025-01-19 06:00"],
            &layout("Europe/Paris"),
            noon,
        ),
        (
            "time (GMT +01:00)",
            ["2025-01-19 13:00", "2025-01-19 14:00"],
            &utc,
            noon,
        ),
        (
            "time (UTC)",
            ["2025-01-19 12:00", "2025-01-19 13:00"],
            &layout(""),
            noon,
        ),
    ] {
        let (first, since) =
            times(column, &cells, layout).unwrap_or_else(|error| panic!("{cells:?}: {error}"));
        assert_eq!(first.as_deref(), Some(start), "{cells:?}");
        assert!((since[1] - HOUR).abs() < 0.01, "{cells:?}: {since:?}");
    }
    // A leap second lies between its neighbours.
    let leap = [
        "2016-12-31T23:59:59Z",
        "2016-12-31T23:59:60Z",
        "2017-01-01T00:00:00Z",
    ];
    assert_eq!(
        times("time", &leap, &layout("")).unwrap().1,
        [0.0, 0.5, 1.0]
    );
    // A month of hours as the German weather service writes them.
    let hours: Vec<String> = (0..59 * 24)
        .map(|h| format!("2025{:02}{:02}{:02}", 1 + h / 744, 1 + h % 744 / 24, h % 24))
        .collect();
    let hours: Vec<&str> = hours.iter().map(String::as_str).collect();
    assert_eq!(
        times("time", &hours, &utc).unwrap().1.last(),
        Some(&(HOUR * (59.0 * 24.0 - 1.0)))
    );
}

/// Year first with two digits, in rows that need no sorting then; two forms, and rows out of order.
#[test]
fn the_order_of_dates_is_the_one_in_which_rows_are_in_order() {
    let utc = layout("UTC");
    let read = |cells: &[&str]| times("time", cells, &utc);
    let said = |cells: &[&str]| {
        let rows: String = cells
            .iter()
            .enumerate()
            .map(|(i, cell)| format!("{cell};{i}\n"))
            .collect();
        read_as(&utc, format!("time;temperature_degC\n{rows}").as_bytes())
            .unwrap()
            .repairs
            .sentences()
    };
    let spring = [
        "23/04/15 12:00",
        "23/04/15 12:10",
        "23/04/15 12:20",
        "23/05/02 12:20",
    ];
    let (start, since) = read(&spring).unwrap();
    assert_eq!(
        (start.as_deref(), since[3]),
        (Some("2023-04-15T12:00:00Z"), 17.0 * 24.0 * HOUR + 1200.0)
    );
    assert_eq!(
        said(&spring),
        ["took dates as ymd, the order in which the rows are sorted by time"]
    );
    let days: Vec<String> = (0..143)
        .map(|i| format!("19-{:02}-{:02}", 3 + i / 28, 1 + i % 28))
        .collect();
    let days: Vec<&str> = days.iter().map(String::as_str).collect();
    let (start, since) = read(&days).unwrap();
    assert!(
        start.as_deref() == Some("2019-03-01T00:00:00Z") && since[142] < 160.0 * 24.0 * HOUR,
        "{since:?}"
    );
    // Day and month, where only one order needs no sorting.
    let (start, _) = read(&["05/06/2025", "06/06/2025", "01/07/2025"]).unwrap();
    assert_eq!(start.as_deref(), Some("2025-06-05T00:00:00Z"));
    let error = read(&["05/06/2025", "06/06/2025", "07/06/2025"]).unwrap_err();
    assert!(
        error.problem.contains("may be exchanged") && !error.remedy.contains("ymd"),
        "{error}"
    );
    let error = read(&["19/01/25 12:00", "19/01/25 13:00"]).unwrap_err();
    assert!(
        error.problem.contains("may be exchanged") && error.remedy.contains("--dates ymd"),
        "{error}"
    );
    for other in [
        "14/01/2025",
        "2025/01/14",
        "14.1.2025",
        "20250114",
        "14-01-25",
    ] {
        let error = read(&["2025-01-13", other]).unwrap_err();
        assert!(
            error.problem.contains("different date format") && error.line == Some(3),
            "{error}"
        );
    }
    let shuffled: Vec<String> = (0..28)
        .map(|i| format!("2025-01-{:02}", 1 + i * 13 % 28))
        .collect();
    let shuffled: Vec<&str> = shuffled.iter().map(String::as_str).collect();
    let error = read(&shuffled).unwrap_err();
    assert!(
        error.problem.contains("two in five rows") && error.remedy.contains("--dates"),
        "{error}"
    );
    let backwards: Vec<&str> = days.iter().rev().copied().collect();
    assert_eq!(
        read(&backwards).unwrap().0.as_deref(),
        Some("2019-03-01T00:00:00Z")
    );
}

/// The zone in a name prevails over one that was given, and that is said.
#[test]
fn a_zone_in_a_name_prevails() {
    let text =
        "\"Date Time, GMT -0700\",Temp (C)\n2018-06-21 15:00:00,20.15\n2018-06-21 16:10:00,19.57\n";
    for (zone, said) in [("", 0), ("-07:00", 0), ("Europe/Paris", 1)] {
        let table = read_as(&layout(zone), text.as_bytes()).unwrap();
        assert_eq!(
            table.start.map(|start| start.to_string()).as_deref(),
            Some("2018-06-21T22:00:00Z")
        );
        assert_eq!(table.repairs.sentences().len(), said, "{:?}", table.repairs);
    }
    let said = read_as(&layout("UTC"), text.as_bytes())
        .unwrap()
        .repairs
        .sentences();
    assert_eq!(said, ["took times in -07, from the name of their column"]);
}

/// A file without a line of names has columns that are called by their numbers.
#[test]
fn columns_without_names_have_numbers() {
    let text = "Logger: TL-20\n2025-01-01 00:00,7,1.5\n2025-01-01 01:00,7,-2\n";
    let of = |time: &str| Layout {
        time: Some(time.into()),
        ..layout("UTC")
    };
    let wanted = |unit| [Wanted::of(ColumnQuantity::Displacement, Some("3"), unit)];
    let table = parse("t.csv", text.as_bytes(), &of("1"), &wanted(Some("mm"))).unwrap();
    assert_eq!(
        (&table.columns[0].times[..], &table.columns[0].values[..]),
        (&[0.0, HOUR][..], &[1.5e-3, -2e-3][..])
    );
    assert_eq!((table.rows, table.repairs.skipped), (2, 1));
    let error = parse("t.csv", text.as_bytes(), &of("1"), &wanted(None)).unwrap_err();
    assert!(error.problem.contains("gives no unit"), "{error}");
    let error = parse("t.csv", text.as_bytes(), &of("4"), &wanted(None)).unwrap_err();
    assert!(
        error.problem.contains("not the names of the columns"),
        "{error}"
    );
}

/// Years, days of the year and times of day in columns of their own, two hours apart.
#[test]
fn days_of_the_year_are_dates() {
    for (names, rows, time) in [
        ("Year,DOY,Hour", ["2024,366,23", "2025,1,1"], None),
        ("Year,DOY,HHMM", ["2024,366,2300", "2025,1,100"], None),
        (
            "Year,Day of Year,Time",
            ["2024,366,23:00", "2025,1,01:00"],
            None,
        ),
        (
            "yy,dd,hh",
            ["2024,366,23.0", "2025,1,1.0"],
            Some("yy,dd,hh"),
        ),
        (
            "yy,dd,n",
            ["2024,366.0,1", "2024,366.083333333,2"],
            Some("yy,dd"),
        ),
    ] {
        let text = format!("{names},temperature_degC\n{},1\n{},2\n", rows[0], rows[1]);
        let table = read_as(
            &Layout {
                time: time.map(String::from),
                ..layout("UTC")
            },
            text.as_bytes(),
        )
        .unwrap_or_else(|error| panic!("{names}: {error}"));
        assert!(
            (table.columns[0].times[1] - 2.0 * HOUR).abs() < 0.1,
            "{names}: {:?}",
            table.columns[0].times
        );
        assert!(
            table.start.unwrap().to_string().starts_with("2024-12-31"),
            "{names}: {:?}",
            table.start
        );
    }
    let error = read_as(
        &layout("UTC"),
        b"Year,DOY,Hour,temperature_degC\n2023,365,23,1\n2023,366,0,2\n",
    )
    .unwrap_err();
    assert!(
        error.problem.contains("is not a date and a time") && error.line == Some(3),
        "{error}"
    );
}

/// What may be a date in two ways, or a number, is refused with a remedy that leads on.
#[test]
fn a_number_or_a_date_that_may_be_another_is_refused() {
    let (none, utc) = (layout(""), layout("UTC"));
    for (column, cell, layout, says, remedy) in [
        (
            "time",
            "2025010123",
            &none,
            "is the date 2025-01-01T23:00:00 without a zone",
            "--zone UTC",
        ),
        (
            "time_h",
            "2025010123",
            &none,
            "looks like the date 2025-01-01T23:00:00",
            "`time`",
        ),
        (
            "time_s",
            "20250101230000",
            &none,
            "looks like the date",
            "`time`",
        ),
        (
            "time",
            "45658.5",
            &none,
            "may be a spreadsheet date, 2025-01-01T12:00:00",
            "--zone UTC",
        ),
        (
            "time",
            "17",
            &utc,
            "is a plain number, but a time zone",
            "remove the zone",
        ),
        (
            "time_h",
            "17",
            &utc,
            "is a plain number, but a time zone",
            "remove the zone",
        ),
        (
            "time",
            "05/06/2025 12:00",
            &utc,
            "day and month may be exchanged",
            "--dates dmy",
        ),
        (
            "time",
            "12:10",
            &utc,
            "is a time of day without a date",
            "--time Date,Time",
        ),
        (
            "time",
            "2025-01-19 12:00",
            &none,
            "without a zone",
            "--zone UTC",
        ),
        (
            "time",
            "2025-01-32 12:00",
            &utc,
            "not a known time format",
            "2015-08-13 00:10",
        ),
        (
            "time",
            "2025-01-19 25:00",
            &utc,
            "not a known time format",
            "2015-08-13 00:10",
        ),
        (
            "time",
            "2025-01-19 12:00 CST",
            &utc,
            "ends with `CST`, a time zone that is unknown or has several meanings",
            "an offset such as +01:00",
        ),
    ] {
        let error = times(column, &[cell, cell], layout).expect_err(cell);
        assert!(
            error.problem.contains(says) && error.remedy.contains(remedy),
            "{cell}: {error}"
        );
    }
    let error = times("time", &["2025010123", "202501022"], &utc).unwrap_err();
    assert!(error.problem.contains("different date format"), "{error}");
    for (wording, remedy) in [
        (Wording::Key, "`zone = \"UTC\"`"),
        (Wording::TemperatureFlag, "`--zone UTC`"),
        (Wording::Argument, "`zone=\"UTC\"`"),
    ] {
        let error = times(
            "time",
            &["2025-01-19"],
            &Layout {
                wording,
                ..Layout::default()
            },
        )
        .unwrap_err();
        assert!(error.remedy.contains(remedy), "{error}");
    }
}

/// A difference of 9 degrees Fahrenheit is 5 K, whatever the column is called.
#[test]
fn a_unit_is_found_wherever_it_stands_in_a_name() {
    let rise = |name: &str, unit: Option<&str>, cells: [&str; 2]| -> Result<f64, DataError> {
        let text = format!("time_s;{name}\n0;{}\n1;{}\n", cells[0], cells[1]);
        let values = &parse(
            "t.csv",
            text.as_bytes(),
            &layout(""),
            &[Wanted::of(ColumnQuantity::Temperature, Some(name), unit)],
        )?
        .columns[0]
            .values;
        Ok(values[1] - values[0])
    };
    for name in [
        "temperature \u{b0}F",
        "temp F",
        "temperature_F_avg",
        "temperatureF",
        "temperature_degreesF",
        "temperature_degF",
        "Temp, \u{b0}F (LGR S/N: 1234567, SEN S/N: 1234567, LBL: north)",
        "Temp (\u{b0}F)",
        "T [F]",
        "AirTF_Avg",
        "temp_deg_F",
        "temperature (degrees Fahrenheit)",
        "TEMPERATURE_F",
        "Temperature (F) mean",
        "temperature_R",
        "temp_\u{ba}F",
        "Temp *F",
        "temp \u{2109}",
    ] {
        assert!(
            (rise(name, None, ["50", "59"]).unwrap_or_else(|error| panic!("{error}")) - 5.0).abs()
                < 1e-12,
            "{name}"
        );
    }
    for name in [
        "temperature_degC",
        "degree_C",
        "degrees_Celsius",
        "temp \u{b0}C",
        "temperature [K]",
        "temperature_kelvin",
        "AirTC_Avg",
        "Temp. (deg C)",
        "T",
        "air temperature",
        "temperature_north",
        "temperature (mean)",
        "temperature *C",
        "Temp (*C)",
        "Temp \u{2103}",
        "Temp\u{2103}",
    ] {
        assert_eq!(
            rise(name, None, ["50", "59"]).unwrap_or_else(|error| panic!("{error}")),
            9.0,
            "{name}"
        );
    }
    assert_eq!(
        rise("temperature_0.1degC", None, ["50", "140"]).unwrap(),
        9.0
    );
    assert_eq!(
        rise("temperature (0.1 \u{b0}C)", None, ["50", "140"]).unwrap(),
        9.0
    );
    assert_eq!(rise("temp_mK", None, ["280000", "289000"]).unwrap(), 9.0);
    assert!((rise("temperature_0.1degF", None, ["500", "590"]).unwrap() - 5.0).abs() < 1e-12);
    assert!((rise("T", Some("degF"), ["50", "59"]).unwrap() - 5.0).abs() < 1e-12);
    assert!((rise("T", Some("\u{b0}F"), ["50", "59"]).unwrap() - 5.0).abs() < 1e-12);
    assert!(
        rise("temperature_C_F", None, ["50", "59"])
            .unwrap_err()
            .problem
            .contains("two units")
    );
    assert!(
        rise("temperature (mV)", None, ["50", "59"])
            .unwrap_err()
            .problem
            .contains("the unknown unit `mV`")
    );
    let said = |name: &str| {
        read_as(&layout(""), format!("time_s,{name}\n0,1\n1,2\n").as_bytes())
            .unwrap()
            .repairs
            .sentences()
    };
    assert_eq!(
        said("temperature"),
        ["read `temperature` in degrees Celsius or kelvin (no unit given)"]
    );
    assert!(said("temperature_K").is_empty());
}

/// A record of 200 hours between 5 and 30 degrees, with one cell replaced.
fn record_with(cells: &[(usize, &str)]) -> String {
    let value = |i: usize| 17.5 + 12.5 * (i as f64 * 0.26).sin();
    let mut rows: Vec<String> = (0..200).map(|i| format!("{i},{:.2}", value(i))).collect();
    for (place, cell) in cells {
        rows[*place] = format!("{place},{cell}");
    }
    format!("time_h,temperature_degC\n{}\n", rows.join("\n"))
}

#[test]
fn marks_of_missing_values_are_left_out_and_counted() {
    let words = [
        "Not av.", "---", "-", "------", "NaN", "N/A", "#N/A", "null", "",
    ];
    for mark in words.into_iter().chain([
        "9.96921e36",
        "9.969209968386869e+36",
        "1e20",
        "3.4028235e38",
    ]) {
        let text = record_with(&[(50, mark), (51, mark), (120, mark)]);
        let table =
            read_as(&layout(""), text.as_bytes()).unwrap_or_else(|error| panic!("{mark}: {error}"));
        assert_eq!(table.columns[0].values.len(), 197, "{mark}");
        assert_eq!(
            table.repairs.sentences(),
            ["left out 3 cells without a value in `temperature_degC`"],
            "{mark}"
        );
    }
    // Marks of one's own.
    let own = |mark: &str| Layout {
        missing: vec![mark.into()],
        ..layout("")
    };
    for (mark, cells) in [
        ("20", ["20.0", "20"]),
        ("Ausfall", ["ausfall", "Ausfall"]),
        ("-9999", ["-9999.0", "-9999"]),
    ] {
        let text = record_with(&[(50, cells[0]), (90, cells[1])]);
        assert_eq!(
            read_as(&own(mark), text.as_bytes()).unwrap().columns[0]
                .values
                .len(),
            198,
            "{mark}"
        );
    }
}

/// A number that may be a mark or a wrong sample is kept, and the first place of the value that
/// stands out most is said; where it can be no temperature, it is refused.
#[test]
fn what_stands_out_is_said_and_kept() {
    for mark in [
        "9999.9", "999.9", "7999", "-99.9", "85", "-127", "32767", "123456.7",
    ] {
        let text = record_with(&[(50, mark), (51, mark), (120, mark)]);
        let table = read_as(&layout(""), text.as_bytes()).unwrap();
        assert_eq!(table.columns[0].values.len(), 200, "{mark}");
        let says = format!("kept the outlier `temperature_degC` = {mark} in line 52 and 2 others");
        assert!(
            table.repairs.sentences()[0].starts_with(&says),
            "{:?}",
            table.repairs
        );
    }
    // A temperature below absolute zero in any unit is missing, whether a unit is known or not; one that
    // is only below that of its unit speaks of a wrong unit.
    for mark in ["-9999", "-999.0", "-32768"] {
        for unit in ["degC", "north", "K"] {
            let text = record_with(&[(50, mark)]).replace("degC", unit);
            let table = read_as(&layout(""), text.as_bytes()).unwrap();
            assert_eq!(
                (table.columns[0].values.len(), table.repairs.columns[0].cold),
                (199, 1),
                "{mark} {unit}"
            );
            let says =
                format!("treated 1 value below absolute zero as missing in `temperature_{unit}`");
            assert!(
                table.repairs.sentences().contains(&says),
                "{:?}",
                table.repairs
            );
        }
    }
    let error = read_as(&layout(""), record_with(&[(50, "-300")]).as_bytes()).unwrap_err();
    assert!(
        error.problem.contains("below absolute zero") && error.line == Some(52),
        "{error}"
    );
    assert!(error.remedy.contains("--missing=-300"), "{error}");
    // A few in a row that differ from all around them are left out if that is asked for.
    let text = record_with(&[(50, "71.3"), (51, "72")]);
    let table = read_as(&layout(""), text.as_bytes()).unwrap();
    assert!(
        table.repairs.sentences()[0].contains("72 in line 53"),
        "{:?}",
        table.repairs
    );
    let table = read_as(
        &Layout {
            outliers: Some(8),
            ..layout("")
        },
        text.as_bytes(),
    )
    .unwrap();
    assert_eq!(
        (
            table.columns[0].values.len(),
            table.repairs.columns[0].outliers
        ),
        (198, 2)
    );
    assert_eq!(
        table.repairs.sentences(),
        ["left out 2 outliers in `temperature_degC`"]
    );
}

/// Numbers that are marks elsewhere are values where others lie about them.
#[test]
fn a_value_that_others_lie_about_is_no_mark() {
    let steam: String = (0..100).map(|i| format!("{i},{}\n", 60 + i % 41)).collect();
    let table = read_as(
        &layout(""),
        format!("time_h,temperature_degC\n{steam}").as_bytes(),
    )
    .unwrap();
    assert_eq!(
        (
            table.columns[0].values.len(),
            table.repairs.sentences().len()
        ),
        (100, 0)
    );
    // A step is no outlier, nor is a slip.
    let step: String = (0..100)
        .map(|i| format!("{i},{}\n", if i < 70 { i % 3 } else { 90 + i % 4 }))
        .collect();
    let table = read_as(
        &layout(""),
        format!("time_h,temperature_degC\n{step}").as_bytes(),
    )
    .unwrap();
    assert_eq!(
        (
            table.columns[0].values.len(),
            table.repairs.sentences().len()
        ),
        (100, 0)
    );
}

#[test]
fn the_names_of_the_columns_are_found_in_what_loggers_write() {
    let toa5 = "\"TOA5\",\"station\",\"CR1000\",\"1234\",\"CR1000.Std.32\",\"CPU:a.CR1\",\"4711\",\"Table1\"\n\
                \"TIMESTAMP\",\"RECORD\",\"Temp_Avg\",\"Batt\"\n\"TS\",\"RN\",\"Deg F\",\"Volts\"\n\"\",\"\",\"Avg\",\"Smp\"\n\
                \"2025-01-01 00:00:00\",0,50.0,13.1\n\"2025-01-01 01:00:00\",1,59.0,13.1\n";
    let hobo = "\"Plot Title: bridge\"\n\"#\",\"Date Time, GMT-05:00\",\"Temp, \u{b0}F (LGR S/N: 1, SEN S/N: 1)\",\"Host Connected (LGR S/N: 1)\"\n\
                1,01/13/25 12:00:00 AM,50.0,\n2,01/13/25 01:00:00 AM,59.0,\n3,01/13/25 01:30:00 AM,,Logged\n";
    let preamble: String = (1..24)
        .map(|i| format!("\"Station {i}\",\"x\"\n"))
        .collect();
    let canada = format!(
        "{preamble}\"Date/time\",\"Year\",\"Temp (\u{b0}F)\",\"\"\n\"2025-01-01 00:00\",\"2025\",\"50.0\",\"\"\n\"2025-01-01 01:00\",\"2025\",\"59.0\",\"\"\n"
    );
    let units = "time;temperature\ns;degF\n0;50\n3600;59\n";
    let sep = "sep=;\ntime_h;temperature_degF\n0;50\n1;59\n";
    let pound = "# logger 7\n#time_h,temperature_degF\n0,50\n1,59\n";
    let two = "Datum;Tid;Temperature F\n2025-01-01;00:00;50\n2025-01-01;01:00;59\n";
    let two_usual = "Date,Time,Temperature F\n01/13/2025,12:00 AM,50\n01/13/2025,1:00 AM,59\n";
    let latin: Vec<u8> = "time_h;Temp \u{b0}F\n0;50\n1;59\n"
        .chars()
        .map(|c| c as u8)
        .collect();
    let utf16: Vec<u8> = [0xfeffu16]
        .into_iter()
        .chain("time_h;Temp \u{b0}F\r\n0;50\r\n1;59\r\n".encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    let of = |time: &str| Layout {
        time: Some(time.into()),
        ..layout("UTC")
    };
    for (what, text, layout) in [
        ("TOA5", toa5.as_bytes(), layout("UTC")),
        ("HOBO", hobo.as_bytes(), layout("")),
        (
            "23 lines before the names",
            canada.as_bytes(),
            layout("UTC"),
        ),
        (
            "23 lines to skip",
            canada.as_bytes(),
            Layout {
                skip: Some(23),
                ..layout("UTC")
            },
        ),
        ("a row of units", units.as_bytes(), layout("")),
        ("sep=", sep.as_bytes(), layout("")),
        ("names in a comment", pound.as_bytes(), layout("")),
        ("date and time", two.as_bytes(), of("Datum,Tid")),
        ("usual date and time", two_usual.as_bytes(), layout("UTC")),
        ("Latin-1", &latin, layout("")),
        ("UTF-16", &utf16, layout("")),
    ] {
        let table = read_as(&layout, text).unwrap_or_else(|error| panic!("{what}: {error}"));
        let column = &table.columns[0];
        assert_eq!(column.times[..2], [0.0, HOUR], "{what}");
        assert!(
            (column.values[0] - 10.0).abs() < 1e-12 && (column.values[1] - 15.0).abs() < 1e-12,
            "{what}: {:?}",
            column.values
        );
    }
    let start = read_as(&layout(""), hobo.as_bytes())
        .unwrap()
        .start
        .map(|start| start.to_string());
    assert_eq!(start.as_deref(), Some("2025-01-13T05:00:00Z"));
    let said = read_as(&layout("UTC"), canada.as_bytes())
        .unwrap()
        .repairs
        .sentences();
    assert_eq!(said[0], "skipped 23 lines before the header");
}

#[test]
fn what_is_not_found_is_asked_for_by_its_flag() {
    let preamble: String = (1..24)
        .map(|i| format!("\"Station {i}\",\"x\"\n"))
        .collect();
    let canada = format!("{preamble}\"When\",\"\",\"Temp\"\n\"2025-01-01 00:00\",\"\",\"50.0\"\n");
    for (text, layout, line, says, remedy) in [
        (
            &canada[..],
            layout("UTC"),
            Some(24),
            "no column is called `time`",
            "`When`, `Temp`",
        ),
        (
            "time_s,temperature_a,temperature_b\n0,1,2\n",
            layout(""),
            None,
            "2 columns match",
            "`--temperature temperature_a`",
        ),
        (
            "time_s,air,steel\n0,1,2\n",
            layout(""),
            None,
            "no column has a name that begins with `temperature`",
            "--temperature air",
        ),
        (
            "time_s,Tair,RH\n0,1,2\n",
            layout(""),
            None,
            "no column has a name",
            "--temperature Tair`",
        ),
        (
            "TIMESTAMP,Air Temperature (C),RH\n0,1,2\n",
            layout(""),
            None,
            "no column",
            "--temperature 'Air Temperature (C)'`",
        ),
        (
            "Time (-),AirTC_Avg,Batt\n0,1,2\n",
            layout(""),
            None,
            "no column",
            "--temperature AirTC_Avg`",
        ),
        (
            "Logger: TL-20\n2025-01-01 00:00;1.5\n",
            layout("UTC"),
            Some(1),
            "not the names of the columns",
            "--time 1",
        ),
        (
            "Logger: TL-20\nWann;Luft\n2025-01-01;1.5\n",
            layout("UTC"),
            Some(2),
            "no column",
            "`Wann`, `Luft`",
        ),
        (
            "2025-01-01 00:00,1.5\n",
            layout("UTC"),
            Some(1),
            "contains numbers or dates",
            "--time 1` and `--temperature 2",
        ),
        (
            "Datum,Tid,temperature_C\n2025-01-01,00:00,1\n2025-01-01,01:00,2\n",
            Layout {
                time: Some("Datum".into()),
                ..layout("UTC")
            },
            Some(3),
            "at the same time as line 2",
            "--time Datum,Tid",
        ),
        (
            "time_s,temperature_C\n0,\"15,250\"\n1,\"1,250\"\n",
            layout(""),
            Some(2),
            "decimals or thousands",
            "`--decimal .` if commas separate thousands, `--decimal ,`",
        ),
        (
            "time_s,temperature_C\n0,\"285,150.0\"\n1,\"286,250.0\"\n",
            layout(""),
            Some(2),
            "commas between thousands",
            "--decimal .`",
        ),
        (
            "time_s;temperature_C\n0;285.150,0\n1;286.250,0\n",
            layout(""),
            Some(2),
            "points between thousands",
            "--decimal ,`",
        ),
        (
            "time_s;temperature_C\n0;285,150.0\n1;286,250.0\n",
            Layout {
                decimal: Some(','),
                ..layout("")
            },
            Some(2),
            "commas between thousands",
            "--decimal .`",
        ),
    ] {
        let error = read_as(&layout, text.as_bytes()).expect_err(text);
        assert_eq!(error.line, line, "{error}");
        assert!(
            error.problem.contains(says) && error.remedy.contains(remedy),
            "{error}"
        );
    }
    let read = |cells: [&str; 2], decimal: Option<char>| {
        let text = format!(
            "time_s,temperature_C\n0,\"{}\"\n1,\"{}\"\n",
            cells[0], cells[1]
        );
        read_as(
            &Layout {
                decimal,
                ..layout("")
            },
            text.as_bytes(),
        )
        .map(|table| table.columns[0].values.clone())
    };
    for (cells, decimal, values) in [
        (["15,5", "16,25"], None, [15.5, 16.25]),
        (["6,207", "1,95"], None, [6.207, 1.95]),
        (["6,207", "0,195"], None, [6.207, 0.195]),
        (["6,207", "1,950"], Some(','), [6.207, 1.95]),
        (["6,207", "1,950.5"], Some('.'), [6207.0, 1950.5]),
        (["6.207,5", "-1,950"], Some(','), [6207.5, -1.95]),
    ] {
        assert_eq!(read(cells, decimal), Ok(values.to_vec()), "{cells:?}");
    }
    assert!(
        read(["6,207", "1,95"], Some('.'))
            .unwrap_err()
            .problem
            .contains("is not a number")
    );
    let key = Layout {
        wording: Wording::Key,
        ..layout("")
    };
    let error = read_as(&key, b"time_s,temperature_C\n0,\"1,250\"\n").unwrap_err();
    assert!(error.remedy.contains("`decimal = \",\"`"), "{error}");
}

/// Two loggers with their own columns, clocks, orders of dates, units and encodings. What is wrong
/// with both files is said at once.
#[test]
fn two_files_have_layouts_of_their_own() {
    let air = "Zeitpunkt;Lufttemperatur\n14.07.2025 02:00;50,0\n14.07.2025 03:00;59,0\n";
    let sensor = "Date,Time,gauge 3\n07/13/2025,7:30 PM,1.0\n07/13/2025,8:30 PM,3.0\n";
    let temperature = ColumnSource {
        column: Some("Lufttemperatur".into()),
        unit: Some("degF".into()),
        layout: Layout {
            time: Some("Zeitpunkt".into()),
            zone: Some("Europe/Berlin".into()),
            ..Layout::default()
        },
        ..ColumnSource::default()
    };
    let displacement = ColumnSource {
        column: Some("gauge 3".into()),
        unit: Some("mm".into()),
        layout: layout("America/New_York"),
        ..ColumnSource::default()
    };
    let both = |temperature: &ColumnSource, displacement: &ColumnSource| {
        BearingData::read(
            Origin::Text("z.csv", sensor),
            Some(Origin::Text("t.csv", air)),
            temperature,
            displacement,
        )
    };
    let data = both(&temperature, &displacement).unwrap();
    assert_eq!(
        (data.temperature.times, data.displacement.times),
        (vec![0.0, HOUR], vec![-0.5 * HOUR, 0.5 * HOUR])
    );
    assert_eq!(
        (data.temperature.values, data.displacement.values),
        (vec![10.0, 15.0], vec![1e-3, 3e-3])
    );
    let bare = ColumnSource {
        layout: Layout {
            wording: Wording::TemperatureFlag,
            ..Layout::default()
        },
        ..ColumnSource::default()
    };
    let error = both(&bare, &ColumnSource::default())
        .unwrap_err()
        .to_string();
    assert_eq!(
        error.matches("t.csv: no column").count() + error.matches("z.csv: no column").count(),
        3,
        "{error}"
    );
    // With the columns named, everything else is asked for at once, and then nothing more.
    let named = |of: &ColumnSource| ColumnSource {
        unit: None,
        layout: Layout {
            zone: None,
            ..of.layout.clone()
        },
        ..of.clone()
    };
    let error = both(&named(&temperature), &named(&displacement))
        .unwrap_err()
        .to_string();
    assert_eq!(error.matches("without a zone").count(), 2, "{error}");
    assert!(error.contains("gives no unit"), "{error}");
}

/// Arrays have the checks and repairs of files.
#[test]
fn arrays_are_repaired_as_files_are() {
    let times: Vec<f64> = (0..200).map(f64::from).collect();
    let mut values: Vec<f64> = times
        .iter()
        .map(|t| 17.0 + 10.0 * (t * 0.26).sin())
        .collect();
    (values[3], values[50], values[120]) = (f64::NAN, 9999.9, -127.0);
    let air = |layout: &Layout| {
        arrays(&[(ColumnQuantity::Temperature, &times, &values)], layout).unwrap()
    };
    let (columns, repairs) = air(&Layout::default());
    assert_eq!((columns[0].values.len(), columns[0].times[3]), (199, 4.0));
    let said = repairs.sentences().join("; ");
    assert!(
        said.contains("1 cell without a value") && said.contains("9999.9 in line 51"),
        "{said}"
    );
    assert_eq!(
        air(&Layout {
            outliers: Some(8),
            ..Layout::default()
        })
        .0[0]
            .values
            .len(),
        197
    );
    let backwards: Vec<f64> = times.iter().rev().copied().collect();
    assert_eq!(
        arrays(
            &[(ColumnQuantity::Temperature, &backwards, &times)],
            &Layout::default()
        )
        .unwrap()
        .1
        .unsorted,
        199
    );
    let error = arrays(
        &[(ColumnQuantity::Temperature, &[0.0, f64::NAN], &[1.0, 2.0])],
        &Layout::default(),
    )
    .unwrap_err();
    assert!(
        error.problem.contains("has a time that is missing"),
        "{error}"
    );
    let error = arrays(
        &[(
            ColumnQuantity::Displacement,
            &[0.0, 1.0],
            &[f64::INFINITY, 2.0],
        )],
        &Layout::default(),
    )
    .unwrap_err();
    assert!(
        error.to_string().contains("is not finite (value 1)"),
        "{error}"
    );
    let error = arrays(
        &[(ColumnQuantity::Displacement, &[0.0, 0.0], &[1.0, 2.0])],
        &Layout::default(),
    )
    .unwrap_err();
    assert!(error.problem.contains("at the same time"), "{error}");
}

/// A smooth record without noise, as of a simulation, has no spikes, not even at its ends.
#[test]
fn a_smooth_record_has_no_outliers() {
    for step in [1e-3, 1e-2, 0.1, 0.5] {
        let rows: String = (0..5000)
            .map(|i| format!("{i},{:.4}\n", (1.0 + step * f64::from(i)).sin()))
            .collect();
        let table = read_as(
            &layout(""),
            format!("time_h,temperature_degC\n{rows}").as_bytes(),
        )
        .unwrap();
        assert_eq!(
            (
                table.columns[0].values.len(),
                table.repairs.sentences().len()
            ),
            (5000, 0),
            "{step}"
        );
    }
}

proptest! {
    /// Whatever the names of the columns and the times are, the reader says what is wrong, or gives
    /// times in ascending order.
    #[test]
    fn no_names_and_no_dates_make_the_reader_panic(
        names in "[a-zT #,;°µ()\\[\\]_.0-9]{0,30}",
        cells in proptest::collection::vec("[0-9:./,TZ+ apmUTCé-]{0,24}", 1..6),
        (zone, dates, skip) in (proptest::option::of(Just("Europe/Paris")), 0..4usize, proptest::option::of(0..3u64)),
    ) {
        let rows: String = cells.iter().enumerate().map(|(i, cell)| format!("{cell};{i}\n")).collect();
        let layout = Layout {
            zone: zone.map(String::from),
            dates: DateOrder::WORDS.get(dates).map(|(_, order)| *order),
            skip,
            ..Layout::default()
        };
        for text in [format!("time;temperature {names}\n{rows}"), format!("{names}\ntime;temperature\n{rows}"), format!("time {names};temperature\n{rows}")] {
            match read_as(&layout, text.as_bytes()) {
                Ok(table) => prop_assert!(table.columns[0].times.windows(2).all(|pair| pair[0] < pair[1])),
                Err(error) => prop_assert!(error.to_string().contains("fix: ")),
            }
        }
    }
}

/// The name of a column says that its values are means, which last for the usual time between stamps.
#[test]
fn means_last_from_one_stamp_to_the_next() {
    for (name, seconds) in [("temperature_Avg_degC", 1800.0), ("temperature_degC", 0.0)] {
        let text = format!("time_h,{name}\n0,1\n0.5,2\n1,3\n1.5,2\n4,1\n");
        let table = read_as(&layout(""), text.as_bytes()).expect("sound");
        assert_eq!(table.columns[0].averaged, seconds, "{name}");
    }
}

/// Among values that scatter evenly from -1/2 to 1/2, whose usual size is some 0.4, one that is 5 of
/// these off is kept, and one that is 12 off is left out by a limit of 8.
#[test]
fn an_outlier_is_beyond_the_limit_that_was_given() {
    let value = |i: u32| match i {
        20 => 2.0,
        40 => 4.8,
        i => f64::from(i * 37 % 101) / 101.0 - 0.5,
    };
    let rows: String = (0..60).map(|i| format!("{i},{}\n", value(i))).collect();
    let limited = Layout {
        outliers: Some(8),
        ..layout("")
    };
    let text = format!("time_h,temperature_degC\n{rows}");
    let table = read_as(&limited, text.as_bytes()).expect("sound");
    let kept = &table.columns[0].values;
    assert_eq!(
        [
            kept.len(),
            kept.iter().filter(|value| **value > 1.0).count()
        ],
        [59, 1]
    );
}
