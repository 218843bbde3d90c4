use super::*;
use proptest::prelude::*;

/// A file whose column of times is called `time`.
fn time() -> Layout {
    Layout::timed("time")
}

fn temperature(column: &str) -> Wanted<'_> {
    Wanted {
        column: Name::Exactly(column),
        quantity: ColumnQuantity::Temperature,
        unit: None,
        max_gap: None,
        averaged: None,
    }
}

fn displacement(column: &str) -> Wanted<'_> {
    Wanted {
        quantity: ColumnQuantity::Displacement,
        ..temperature(column)
    }
}

/// Read the column `T` of a text.
fn read_t(text: &str) -> Result<Table, DataError> {
    parse("t.csv", text.as_bytes(), &time(), &[temperature("T")])
}

fn in_zone(zone: &'static str, text: &str) -> Result<Table, DataError> {
    parse(
        "t.csv",
        text.as_bytes(),
        &Layout {
            zone: Some(zone.into()),
            ..time()
        },
        &[temperature("T")],
    )
}

/// The times and values of the only column.
fn samples(table: &Table) -> Vec<(f64, f64)> {
    let column = &table.columns[0];
    column
        .times
        .iter()
        .copied()
        .zip(column.values.iter().copied())
        .collect()
}

#[test]
fn stamps_become_seconds_from_the_first() {
    let table = read_t(
        "time,T\n2015-08-13T00:00:00Z,15.5\n2015-08-13 00:10:00.5+00:00,14\n2015-08-13T03:00+02:00,-1e0\n",
    );
    let table = table.unwrap();
    assert_eq!(
        samples(&table),
        [(0.0, 15.5), (600.5, 14.0), (3600.0, -1.0)]
    );
    assert_eq!(
        table.start.map(|start| start.to_string()).as_deref(),
        Some("2015-08-13T00:00:00Z")
    );
    assert_eq!(
        table.start.and_then(|start| start.after(90.0)),
        Start::parse("2015-08-13T00:01:30Z")
    );
    assert_eq!(
        (
            table.rows,
            table.in_seconds,
            table.repairs.sentences().len()
        ),
        (3, true, 1)
    );
    // A stamp without a zone is in the zone that is given, and a date alone is its midnight.
    let table = in_zone("+01:00", "time,T\n2015-08-13 01:00,1\n2015-08-14,2\n").unwrap();
    assert_eq!(samples(&table), [(0.0, 1.0), (82_800.0, 2.0)]);
    assert_eq!(table.start, Start::parse("2015-08-13T00:00:00Z"));
}

#[test]
fn numbers_become_seconds_by_the_unit_in_the_name() {
    for (name, unit) in [
        ("time_s", 1.0),
        ("time_min", 60.0),
        ("time [h]", 3600.0),
        ("t_days", 86_400.0),
        ("t (ms)", 1e-3),
    ] {
        let text = format!("{name},T\n10,1\n12.5,2\n");
        let table = parse(
            "t.csv",
            text.as_bytes(),
            &Layout::timed(name),
            &[temperature("T")],
        )
        .unwrap();
        assert_eq!(samples(&table), [(0.0, 1.0), (2.5 * unit, 2.0)], "{name}");
        assert!(table.in_seconds && table.start.is_none());
    }
    assert!(!read_t("time,T\n0,1\n1,2\n").unwrap().in_seconds);
}

#[test]
fn units_stand_in_the_names_of_columns() {
    let text = b"time,a_degC,b_K,c [degF],d_mm,e (um),f_m,north\n0,1,273.5,50,2.5,30,-0.01,7\n1,2,274,212,5,1,0.5,8\n";
    let wanted = ["a_degC", "b_K", "c [degF]", "north"].map(temperature);
    let wanted: Vec<Wanted<'_>> = wanted
        .into_iter()
        .chain(["d_mm", "e (um)", "f_m"].map(displacement))
        .collect();
    let table = parse("t.csv", text, &time(), &wanted).unwrap();
    let first: Vec<f64> = table
        .columns
        .iter()
        .map(|column| column.values[0])
        .collect();
    assert_eq!(first, [1.0, 273.5, 10.0, 7.0, 0.0025, 30e-6, -0.01]);
    assert_eq!(table.columns[2].values[1], 100.0);
    let given = Wanted {
        unit: Some("cm"),
        ..displacement("north")
    };
    assert_eq!(
        parse("t.csv", text, &time(), &[given]).unwrap().columns[0].values,
        [0.07, 0.08]
    );
    let says = |wanted: Wanted<'_>| {
        parse("t.csv", text, &time(), &[wanted])
            .unwrap_err()
            .to_string()
    };
    assert!(
        says(displacement("north")).contains("gives no unit")
            && says(displacement("north")).contains("north_mm")
    );
    assert!(says(displacement("b_K")).contains("gives no unit"));
    assert!(says(displacement("c [degF]")).contains("the unknown unit `degF`"));
    assert!(
        says(Wanted {
            unit: Some("inch"),
            ..given
        })
        .contains("unknown unit `inch`")
    );
}

/// Factors from the definitions of the units: 1 in = 25.4 mm, 1 ft = 12 in, g = 9.80665 m/s2, 1 lb =
/// 0.45359237 kg.
#[test]
fn an_input_is_converted_from_every_unit() {
    let (inch, gravity, pound) = (0.0254, 9.80665, 0.453_592_37);
    let units = [
        ("m/s2", 1.0),
        ("m/s/s", 1.0),
        ("cm/s2", 0.01),
        ("CM/SEC/SEC", 0.01),
        ("mm/s^2", 1e-3),
        ("um/s2", 1e-6),
        ("ft/s2", 12.0 * inch),
        ("in/s\u{b2}", inch),
        ("in/s2", inch),
        ("g", gravity),
        ("mg", 1e-3 * gravity),
        ("gal", 0.01),
        ("mN", 1e-3),
        ("kN", 1e3),
        ("MN", 1e6),
        ("GN", 1e9),
        ("lbf", pound * gravity),
        ("kip", 1e3 * pound * gravity),
        ("kgf", gravity),
        ("m", 1.0),
        ("cm", 0.01),
        ("mm", 1e-3),
        ("um", 1e-6),
        ("ft", 12.0 * inch),
        ("none", 1.0),
    ];
    for (unit, factor) in units {
        for (name, given) in [
            (format!("a_{unit}"), None),
            (format!("a [{unit}]"), None),
            ("a".into(), Some(unit)),
        ] {
            let table = input(&format!("t_s,{name}\n0,1\n1,-3\n"), given);
            let column = &table
                .unwrap_or_else(|error| panic!("{name}: {error}"))
                .columns[0];
            assert!(
                (column.values[0] - factor).abs() < 1e-15 * factor,
                "{name}: {:?}",
                column.values
            );
            assert_eq!((column.values[1] / column.values[0]).round(), -3.0);
            assert!(!column.unit.is_empty(), "{name}");
        }
    }
    // What else may be a name is none of a unit: N may be north, and in may be an input.
    for name in [
        "ag",
        "ag_x",
        "acc_1",
        "ag_N",
        "ag_NS",
        "ag_ns",
        "acc_V",
        "a_in",
        "a_filtered",
        "a_A",
        "a (avg)",
    ] {
        let table = input(&format!("t_s,{name}\n0,1\n1,-3\n"), None)
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            (&table.columns[0].values[..], table.columns[0].unit),
            (&[1.0, -3.0][..], ""),
            "{name}"
        );
        let said = table.repairs.sentences();
        assert!(
            said.len() == 1 && said[0].contains("in SI units (no unit given"),
            "{name}: {said:?}"
        );
    }
    assert_eq!(
        input("t_s,a [in]\n0,1\n1,2\n", None).unwrap().columns[0].values,
        [inch, 2.0 * inch]
    );
    for unit in [
        "ft/s", "m/s", "mV", "kPa", "psi", "km", "%", "rad/s2", "m^3", "lbs",
    ] {
        for text in [
            format!("t_s,a_{unit}\n0,1\n1,2\n"),
            format!("t_s,a\ns,{unit}\n0,1\n1,2\n"),
        ] {
            let error = input(&text, None).expect_err(unit);
            assert!(error.problem.contains("unknown unit"), "{error}");
            assert_eq!(
                input(&text, Some("g")).unwrap().columns[0].values,
                [gravity, 2.0 * gravity]
            );
        }
    }
    assert!(
        input("t_s,a_mn\n0,1\n1,2\n", None).is_ok_and(|table| table.columns[0].unit.is_empty()),
        "mN or MN"
    );
}

/// Read the column of an input from a text.
fn input(text: &str, unit: Option<&str>) -> Result<Table, DataError> {
    stepping(text, None, None, unit)
}

/// Read an input that has a constant step, if it is given, from a column of this name.
fn stepping(
    text: &str,
    step: Option<f64>,
    column: Option<&str>,
    unit: Option<&str>,
) -> Result<Table, DataError> {
    let time = Some(if text.starts_with("t_s") { "t_s" } else { "1" }.into());
    let wanted = Wanted::called(ColumnQuantity::Input, column, "A", unit);
    parse(
        "a.txt",
        text.as_bytes(),
        &Layout {
            step,
            time,
            ..Layout::default()
        },
        &[wanted],
    )
}

/// 0, 0.01 g, -0.02 g and 0.03 g, as the headers of the PEER database and its values may be written.
#[test]
fn records_with_a_constant_step_are_read_in_each_form() {
    let body = "  0.0 .1000E-01-.2000E-01\n  .3000E-01\n";
    let at2 = |third: &str, fourth: &str, body: &str, unit: Option<&str>| {
        input(
            &format!("PEER\nPLACE, 1/1/1979\n{third}\n{fourth}\n{body}"),
            unit,
        )
    };
    let in_g = "ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=40.0 Hz";
    let plain = "ACCELERATION TIME SERIES";
    let g = 9.80665;
    for (third, fourth, unit, step, factor) in [
        (in_g, "NPTS=  4, DT=   .0125 SEC,", None, 0.0125, g),
        (in_g, "NPTS=4, DT= 10 MSEC", None, 0.01, g),
        (in_g, "   4    0.0100    NPTS, DT", None, 0.01, g),
        (in_g, "NPTS = 4, DT = .005 SEC", Some("g"), 0.005, g),
        (plain, "NPTS = 4, DT = .005 SEC", Some("cm/s2"), 0.005, 0.01),
        (plain, "NPTS=  4, DT= .01", None, 0.01, g),
        (
            "ACCELERATION TIME SERIES IN CM/SEC/SEC",
            "NPTS=  4, DT= .01",
            None,
            0.01,
            0.01,
        ),
        (
            "ACCELERATION TIME SERIES IN UNITS OF CM/S/S",
            "NPTS=  4, DT= .01 SEC",
            None,
            0.01,
            0.01,
        ),
        (
            "ACCELERATION IN (MM/S/S)",
            "NPTS=  4, DT= .01 SEC",
            None,
            0.01,
            1e-3,
        ),
    ] {
        let table =
            at2(third, fourth, body, unit).unwrap_or_else(|error| panic!("{fourth}: {error}"));
        let wanted = [0.0, 0.01, -0.02, 0.03].map(|value| value * factor);
        let near = |a: &[f64], b: &[f64]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15)
        };
        assert!(
            near(&table.columns[0].values, &wanted),
            "{third}: {:?}",
            table.columns[0].values
        );
        assert!(
            near(
                &table.columns[0].times,
                &[0.0, 1.0, 2.0, 3.0].map(|i| i * step)
            ),
            "{fourth}"
        );
        assert_eq!(
            (table.in_seconds, table.repairs.sentences().len()),
            (true, 0),
            "{fourth}"
        );
    }
    for (third, fourth, says) in [
        (
            "IN UNITS OF CM/SEC",
            "NPTS= 4, DT= .01",
            "unknown unit `CM/SEC`",
        ),
        (
            "ACCELERATION IN FURLONGS",
            "NPTS= 4, DT= .01",
            "unknown unit `FURLONGS`",
        ),
        (
            in_g,
            "NPTS= 4, DT= .01 FORTNIGHTS",
            "is not the header of a record",
        ),
        (in_g, "NPTS= 4, DT= 1E-300", "too short"),
    ] {
        let error = at2(third, fourth, body, None).expect_err(fourth);
        assert!(error.problem.contains(says), "{error}");
    }
    let marked = at2(in_g, "NPTS= 4, DT= .01", "0 1 -999 -999", None)
        .unwrap()
        .repairs
        .sentences();
    assert_eq!(
        marked,
        ["kept `value` = -999 in line 5, which often marks a missing value, and 1 other"]
    );
    // Values of which the scenario gives the step: all numbers, or those of a column.
    let read = |text: &str, column| {
        stepping(text, Some(0.5), column, Some("cm/s2")).map(|table| samples(&table))
    };
    let samples = vec![(0.0, 0.01), (0.5, -0.02), (1.0, 0.03)];
    assert_eq!(read("1\n-2\n3\n", None), Ok(samples.clone()));
    assert_eq!(read("# a note\n1 -2\n3", None), Ok(samples.clone()));
    assert_eq!(
        read("0 1\n0.5 -2\n1.0, 3\n", Some("2")),
        Ok(samples.clone())
    );
    for (text, column, says) in [
        ("1 2\n3\n", Some("2"), "`` is not a number"),
        ("1 x\n", None, "`x` is not a number"),
        ("1", None, "1 values"),
        ("1 2", Some("acc"), "by its number"),
        ("2020-01-01 2", None, "`2020-01-01` is not a number"),
    ] {
        assert!(
            read(text, column).is_err_and(|error| error.problem.contains(says)),
            "{text}"
        );
    }
    // Columns that blanks separate.
    let text = "  0.0   1\n  0.5  -2\n  1.0   3\n";
    let table = stepping(text, None, Some("2"), Some("cm/s2")).unwrap();
    assert_eq!((self::samples(&table), table.in_seconds), (samples, false));
}

/// Two numbers in each line, or first numbers that differ by about the step, are times and values.
#[test]
fn a_step_contradicts_a_column_of_times() {
    let read = |text: &str, column| stepping(text, Some(0.5), column, Some("g"));
    let three = "0.0 1 5\n0.5 -2 6\n1.0 3 7\n";
    for text in ["0.0 1\n0.5 -2\n1.0 3\n", "7,8\n9,1\n", three] {
        let error = read(text, None).expect_err(text);
        assert!(
            error
                .problem
                .contains("in each line, but `step` is for values without times"),
            "{error}"
        );
        assert!(
            error.remedy.contains("remove `step`") && error.line == Some(1),
            "{error}"
        );
        assert!(read(text, Some("2")).is_ok());
    }
    // Values wrapped in lines of equal length, even if they grow.
    for text in ["0 1 2\n3 4 5\n6 7 8\n", "1 2 3\n", "1 2\n3\n"] {
        assert!(read(text, None).is_ok(), "{text}");
    }
}

/// A unit, or a step, that contradicts the file is an error, whichever is right.
#[test]
fn what_the_file_says_is_not_overruled() {
    let header = "PEER\nPLACE\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n1 2 3 4\n";
    for unit in ["m/s2", "cm/s2", "kN", "none"] {
        for (text, problem) in [
            (
                header,
                format!("the header gives the unit `G`, but `unit` = \"{unit}\""),
            ),
            (
                "t_s,a_g\n0,1\n1,2\n",
                format!("`a_g` contradicts the unit `{unit}`"),
            ),
            (
                "t_s,a\ns,g\n0,1\n1,2\n",
                "a different unit from its column".into(),
            ),
        ] {
            let error = input(text, Some(unit)).expect_err(text);
            assert!(error.problem.contains(&problem), "{error}");
        }
    }
    assert!(input(header, Some("g's")).is_ok());
    let error = stepping(header, Some(0.01), None, None).expect_err("a step");
    assert!(
        error.problem.contains("AT2") && error.remedy == "remove `step`",
        "{error}"
    );
}

/// The number of a column selects it with and without a line of names.
#[test]
fn a_column_is_named_or_numbered() {
    for text in ["t_s,b_g,a_g\n0,7,1\n1,7,-3\n", "0,7,1\n1,7,-3\n"] {
        let unit = Some("g").filter(|_| !text.starts_with("t_s"));
        let table = stepping(text, None, Some("3"), unit).unwrap();
        let values = &table.columns[0].values;
        assert_eq!(
            (values[0] / 9.80665, values[1] / 9.80665),
            (1.0, -3.0),
            "{text}"
        );
    }
    for column in ["0", "4"] {
        let error = stepping("t_s,b_g,a_g\n0,7,1\n1,7,-3\n", None, Some(column), None);
        assert!(error.is_err_and(|error| error.problem.contains("no column")));
    }
}

/// Only a column of numbers is proposed, and a date and its time of day are one time.
#[test]
fn a_time_is_not_proposed_as_a_value() {
    let read = |text: &str, quantity| {
        let layout = Layout {
            zone: Some("UTC".into()),
            wording: super::Wording::Flag,
            ..Layout::default()
        };
        parse(
            "a.csv",
            text.as_bytes(),
            &layout,
            &[Wanted::of(quantity, None, None)],
        )
    };
    let text = "Datum;Uhrzeit;Weg\n13.08.2015;00:00;1,5\n13.08.2015;00:10;1,6\n";
    let error = read(text, ColumnQuantity::Temperature).expect_err("no temperature");
    assert!(error.remedy.contains("`--temperature Weg`"), "{error}");
    let known = text.replace("Weg", "Temperatur_degC");
    let table = read(&known, ColumnQuantity::Temperature).unwrap();
    assert_eq!(
        (&*table.time, &table.columns[0].times[..]),
        ("Datum,Uhrzeit", &[0.0, 600.0][..])
    );
    let error = read(
        "Datum,Zeit\n2015-08-13,00:00\n2015-08-13,00:10\n",
        ColumnQuantity::Temperature,
    );
    let error = error.expect_err("no numbers");
    assert!(error.remedy.contains("`--temperature NAME`"), "{error}");
}

#[test]
fn what_is_no_record_is_refused_with_its_remedy() {
    for (text, says) in [
        (
            "t_s,a_g\n0,1\n1,inf\n",
            "is not finite\n  fix: correct the cell",
        ),
        (
            "t_s,a_g\n0,1\n1,strong\n",
            "is not a number\n  fix: correct the cell",
        ),
        (
            "t_s,a_g\n0,1\n1e-300,2\n2,3\n",
            "from line 2 to this one is 1e-300 s, too short compared with the record, 2 s",
        ),
        ("t_s,a_g\n0,1\n1e-300,2\n", "too short"),
        (
            "t_s,a_g\n0,1\n1000000,2\n1000000.000000001,3\n",
            "from line 3 to this one",
        ),
        (
            "Origin Time  2011/03/11 14:46:00\n",
            "a record in the format of K-NET and KiK-net\n  fix: convert it",
        ),
        ("EVENT_NAME: X\n", "a record in the format of ESM"),
        (
            "Corrected acceleration (Format v01.20 with 13 text lines)\n",
            "a record in the format of COSMOS",
        ),
    ] {
        let error = input(text, None).expect_err(text).to_string();
        assert!(error.contains(says), "{error}");
    }
    // A steep step is sound, and a number that may be a mark is kept with a warning.
    assert!(input("t_s,a_g\n0,1\n1e-9,2\n1000,3\n", None).is_ok());
    let said = input("t_s,a_g\n0,1\n1,-999\n2,3\n", None)
        .unwrap()
        .repairs
        .sentences();
    assert_eq!(
        said,
        ["kept `a_g` = -999 in line 3, which often marks a missing value"]
    );
}

/// A cell without a displacement leaves out only the displacement of its row, not the temperature,
/// and vice versa.
#[test]
fn columns_of_one_pass_share_their_time_and_nothing_else() {
    let text = b"time_h,temperature_degC,displacement_mm\n0,,1\n1,5,\n2,6,NaN\n3,7,4\n";
    let begins = Wanted {
        column: Name::Beginning("displacement"),
        ..displacement("")
    };
    let time = &Layout::timed("time_h");
    let table = parse(
        "t.csv",
        text,
        time,
        &[temperature("temperature_degC"), begins],
    )
    .unwrap();
    assert_eq!(
        (&table.columns[0].times[..], &table.columns[0].values[..]),
        (&[3600.0, 7200.0, 10_800.0][..], &[5.0, 6.0, 7.0][..])
    );
    assert_eq!(
        (&table.columns[1].times[..], &table.columns[1].values[..]),
        (&[0.0, 10_800.0][..], &[1e-3, 4e-3][..])
    );
    assert_eq!(table.columns[1].name, "displacement_mm");
    let sentences = table.repairs.sentences();
    assert_eq!(
        sentences[0],
        "left out 1 cell without a value in `temperature_degC`"
    );
    assert_eq!(
        sentences[1],
        "left out 2 cells without a value in `displacement_mm`"
    );
    // If only the temperature is wanted, time 0 is at its own first value.
    assert_eq!(
        parse("t.csv", text, time, &[temperature("temperature_degC")])
            .unwrap()
            .columns[0]
            .times[0],
        0.0
    );
}

#[test]
fn rows_are_sorted_and_taken_once_and_that_is_counted() {
    let table = read_t("time,T\n5,1\n3,2\n9,3\n3,2\n4,\n9,3\n7,NA\n").unwrap();
    assert_eq!(samples(&table), [(0.0, 2.0), (2.0, 1.0), (6.0, 3.0)]);
    let said = ["sorted 2 rows out of order", "left out 2 duplicate rows"];
    assert_eq!(table.repairs.sentences()[..2], said);
    assert_eq!(table.repairs.columns[0].missing, 2);
    let text = "time,T\n5,1\n3,2\n5,1.5\n";
    let error = read_t(text).unwrap_err();
    assert_eq!(error.line, Some(4));
    assert!(
        error.problem.contains("at the same time as line 2"),
        "{error}"
    );
}

#[test]
fn files_of_any_system_are_read() {
    let plain = samples(&read_t("time,T\n0,1.5\n1,-2\n").unwrap());
    for text in [
        "\u{feff}time,T\r\n0,1.5\r\n1,-2\r\n",
        "time\tT\n0\t1,5\n1\t-2",
        "# a logger's name\n\n\"time\";\"T\"\n# more\n0;1,5\n\n1 ; -2\n",
        "note,time,T\n\"a, \"\"b\"\"\nc\",0,\"1.5\"\nd,1,-2\n",
        "time,T,\n0,1.5,\n,,\n1,-2,\n",
        "time,T\n0,1.5,\n1,-2,,\n",
        "Time,t\n0,1.5\n1,-2\n",
        "time,T,,\n0,1.5\n1,-2\n",
        "logger\rtime,T\r0,1.5\r1,-2\r",
        "Logger: TL-20\ntime,T,\n0,1.5\n1,-2,\n",
    ] {
        assert_eq!(
            read_t(text).map(|table| samples(&table)),
            Ok(plain.clone()),
            "{text:?}"
        );
    }
    assert_eq!(
        read_t("time;T\n0,5;1,5\n1,5;-2\n")
            .unwrap()
            .repairs
            .decimal_commas,
        1
    );
}

/// In Europe/Paris the clocks skip 02:00 to 03:00 on 2015-03-29, and pass 02:00 to 03:00 twice on
/// 2015-10-25.
#[test]
fn an_hour_that_was_twice_is_told_by_the_order_of_the_rows() {
    let night = "time,T\n2015-10-25 01:30,1\n2015-10-25 02:00,2\n2015-10-25 02:30,3\n2015-10-25 02:00,4\n2015-10-25 02:30,5\n\
                 2015-10-25 03:00,6\n";
    let table = in_zone("Europe/Paris", night).unwrap();
    let half_hours: Vec<f64> = samples(&table)
        .iter()
        .map(|sample| sample.0 / 1800.0)
        .collect();
    assert_eq!(half_hours, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(table.repairs.folds, 4);
    // A record that begins in such an hour begins with the first of the two, an hour before the
    // second.
    let late = "time,T\n2015-10-25 02:30,1\n2015-10-25 03:00,2\n";
    assert_eq!(
        samples(&in_zone("Europe/Paris", late).unwrap())[1].0,
        5400.0
    );
    // In UTC the stamps repeat two times with different values.
    assert!(
        in_zone("UTC", night)
            .unwrap_err()
            .problem
            .contains("another value of `T`")
    );
    let backwards = "time,T\n2015-10-25 03:00,1\n2015-10-25 02:30,2\n";
    let error = in_zone("Europe/Paris", backwards).unwrap_err();
    assert!(
        error.problem.contains("occurred twice") && error.line == Some(3),
        "{error}"
    );
    let error = in_zone(
        "Europe/Paris",
        "time,T\n2015-03-29 01:30,1\n2015-03-29 02:30,2\n",
    )
    .unwrap_err();
    assert!(
        error.problem.contains("does not exist") && error.remedy.contains("+01:00"),
        "{error}"
    );
    assert_eq!(error.cell.as_deref(), Some("`time` = \"2015-03-29 02:30\""));
    let spring = in_zone(
        "Europe/Paris",
        "time,T\n2015-03-29 01:30,1\n2015-03-29 03:30,2\n",
    )
    .unwrap();
    assert_eq!(spring.columns[0].times, [0.0, 3600.0]);
}

#[test]
fn a_gap_is_allowed_up_to_the_longest_one() {
    let text = b"time_h,T\n0,1\n6,2\n\n12.5,3\n13,4\n";
    let time = &Layout::timed("time_h");
    let with = |max_gap| {
        parse(
            "t.csv",
            text,
            time,
            &[Wanted {
                max_gap,
                ..temperature("T")
            }],
        )
    };
    assert!(with(None).is_ok() && with(Some(6.5 * 3600.0)).is_ok());
    let error = with(Some(6.0 * 3600.0)).unwrap_err();
    assert_eq!(error.line, Some(5));
    assert!(
        error
            .problem
            .contains("for 6.5 h, since line 3, longer than the permitted 6 h"),
        "{error}"
    );
}

/// Each mistake in a file is reported with its line, its value and its remedy.
#[test]
fn what_could_be_meant_in_two_ways_is_an_error() {
    for (text, line, says, remedy) in [
        ("", None, "it is empty", "first line names"),
        ("time,T\n", None, "no rows", "measurements"),
        (
            "0,1\n1,2\n",
            Some(1),
            "contains numbers",
            "time_s,temperature_degC",
        ),
        (
            "time,t1,t2\n0,1,2\n",
            None,
            "no column is called `T`",
            "`time`, `t1`, `t2`",
        ),
        (
            "time,Temp\n0,1\n",
            None,
            "no column is called `T`",
            "`time`, `Temp`",
        ),
        ("tiem,T\n0,1\n", None, "did you mean `tiem`?", "`tiem`, `T`"),
        (
            "time,T,T\n0,1,2\n",
            None,
            "2 columns match",
            "different names",
        ),
        (
            "time|T\n0|1\n",
            None,
            "no column is called `time`",
            "commas, semicolons or tabs",
        ),
        (
            "time,T\n0,15,5\n1,14,5\n",
            Some(2),
            "3 cells, but the header names 2 columns",
            "semicolons",
        ),
        (
            "time,T,\n0,1,5,2\n",
            Some(2),
            "4 cells, but the header names 2 columns",
            "semicolons",
        ),
        (
            "time,T\n0,\"+0120,1\"\n1,\"+0137,1\"\n",
            Some(2),
            "a leading zero",
            "split the column",
        ),
        (
            "time,T\n0,1\n1\n",
            Some(3),
            "1 cell, but",
            "skip_bad = true",
        ),
        (
            "time;T\n0;1.5\n1;1,500\n",
            Some(3),
            "mixes decimal commas",
            "decimal points",
        ),
        (
            "time;T\n0;1.234,5\n",
            Some(2),
            "between thousands",
            "without them",
        ),
        (
            "time,T\n0,1\n1,\"1,234\"\n",
            Some(3),
            "decimals or thousands",
            "decimal points",
        ),
        ("time,T\n0,1\n1,\"2\n", Some(3), "", ""),
        (
            "time,T\n0,1\n1,warm\n",
            Some(3),
            "`T` = \"warm\" is not a number",
            "missing = ",
        ),
        (
            "time,T\n0,1\n1,inf\n",
            Some(3),
            "is not finite",
            "missing = ",
        ),
        ("time,T\n0,1\n,2\n", Some(3), "has no time", "remove it"),
        (
            "time,T\n0,1\n2015-01-01,2\n",
            Some(3),
            "is not a number, unlike the times before it",
            "correct the line",
        ),
        (
            "time,T\n0,1\ninf,2\n",
            Some(3),
            "is not a number",
            "correct",
        ),
        (
            "time,T\n2015-01-01 00:00,1\n",
            Some(2),
            "without a zone",
            "zone = \"UTC\"",
        ),
        (
            "time,T\n13/08/2015 00:10,1\n",
            Some(2),
            "without a zone",
            "zone = \"UTC\"",
        ),
        (
            "time,T\n05/06/2015 00:10,1\n",
            Some(2),
            "may be exchanged",
            "dates = \"dmy\"",
        ),
        (
            "time,T\n2015-02-30T00:00:00Z,1\n",
            Some(2),
            "not a known time format",
            "2015-08-13 00:10",
        ),
        (
            "time,T\n0,1\n",
            None,
            "column `T` has 1 value",
            "two values",
        ),
        (
            "time,T\n0,\n1,\n",
            None,
            "column `T` has 0 values",
            "two values",
        ),
    ] {
        let Err(error) = read_t(text) else {
            assert!(says.is_empty() || text.contains("\"2"), "{text:?} was read");
            continue;
        };
        assert_eq!(error.line, line, "{text:?}: {error}");
        assert!(
            error.to_string().contains(says) && error.remedy.contains(remedy),
            "{text:?}: {error}"
        );
        assert!(error.to_string().starts_with("t.csv") && error.to_string().contains("\n  fix: "));
    }
    let cold = parse(
        "t.csv",
        b"time,T_degC\n0,1\n1,-300\n",
        &time(),
        &[temperature("T_degC")],
    )
    .unwrap_err();
    assert!(
        cold.problem.contains("absolute zero") && cold.line == Some(3),
        "{cold}"
    );
    let zone = in_zone("Europe/Pariss", "time,T\n2015-01-01 00:00,1\n").unwrap_err();
    assert!(
        zone.problem.contains("unknown time zone \"Europe/Pariss\""),
        "{zone}"
    );
    for (bytes, says) in [
        (&b"t\0i\0m\0"[..], "UTF-16"),
        (b"PK\x03\x04x", "zip archive"),
        (b"\x89HDF\r\n\x1a\nx", "HDF5"),
        (b"time,T\n0,\xff\n", "is not a number"),
    ] {
        let error = parse("t.csv", bytes, &time(), &[temperature("T")]).unwrap_err();
        assert!(error.problem.contains(says), "{error}");
    }
    let error = read(Path::new("/nowhere/t.csv"), &time(), &[]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("/nowhere/t.csv: cannot be read"),
        "{error}"
    );
    assert!(
        read(Path::new("/"), &time(), &[])
            .unwrap_err()
            .problem
            .contains("directory")
    );
}

/// The text of a cell in a message stays on one line and contains no control characters.
#[test]
fn a_hostile_cell_is_cut_and_defused() {
    let text = format!("time,T\n0,\u{1b}[2J{}\n", "x".repeat(1000));
    let message = read_t(&text).unwrap_err().to_string();
    assert!(
        !message.contains('\u{1b}') && message.len() < 200,
        "{message}"
    );
}

proptest! {
    /// Whatever the order of the rows, the separator, the line ends and the quotes are, the values
    /// are read with every bit.
    #[test]
    fn what_is_written_is_read(
        values in proptest::collection::vec((0..1_000_000u32, proptest::option::of(-459.0..1e3f64)), 2..40),
        (separator, end, quote) in (prop_oneof![Just(","), Just(";"), Just("\t")], prop_oneof![Just("\n"), Just("\r\n")], any::<bool>()),
    ) {
        let mut expected: Vec<(u32, f64)> = values.iter().filter_map(|(time, value)| value.map(|value| (*time, value))).collect();
        expected.sort_by_key(|sample| sample.0);
        let twice = expected.windows(2).any(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1);
        expected.dedup();
        let q = if quote { "\"" } else { "" };
        let mut text = format!("time_s{separator}{q}T{q}{end}");
        for (time, value) in &values {
            let value = value.map_or(String::new(), |value| format!("{value:?}"));
            text += &format!("{time}{separator}{q}{value}{q}{end}");
        }
        let time = &Layout::timed("time_s");
        let read = parse("t.csv", text.as_bytes(), time, &[temperature("T")]);
        if twice || expected.len() < 2 {
            prop_assert!(read.is_err());
        } else {
            let first = expected[0].0;
            let expected: Vec<(f64, f64)> = expected.iter().map(|(t, v)| (f64::from(t - first), *v)).collect();
            prop_assert_eq!(samples(&read.unwrap()), expected);
        }
    }

    /// A stamp with an offset is read as the instant that it names, for every offset.
    #[test]
    fn offsets_are_taken_off(seconds in proptest::collection::btree_set(0..100_000_000i64, 2..20), hours in -12..=14i64) {
        let mut text = String::from("time,T\n");
        for second in &seconds {
            // Unix time 1.4e9 is in 2014; the local clock is ahead by the offset.
            let local = Start::parse("2014-05-13T16:53:20Z").unwrap().after((second + 3600 * hours) as f64).unwrap().to_string();
            text += &format!("{}{}{:02}:00,{second}\n", local.trim_end_matches('Z'), if hours < 0 { '-' } else { '+' }, hours.abs());
        }
        let table = read_t(&text).unwrap();
        let first = *seconds.first().unwrap() as f64;
        for (time, value) in samples(&table) {
            prop_assert_eq!(time, value - first);
        }
    }

    /// No bytes make the reader panic.
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200), text in "[time,T;0-9.\"\n\r#-]{0,80}") {
        for bytes in [&bytes[..], text.as_bytes(), &[b"time,T\n", &bytes[..]].concat(), format!("time;T\n{text}").as_bytes()] {
            if let Err(error) = parse("t.csv", bytes, &time(), &[temperature("T")]) {
                prop_assert!(error.to_string().contains("fix: "));
            }
        }
    }
}
