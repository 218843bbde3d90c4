//! Files with defects that cannot be repaired: exchanged dates, interleaved series, a second header,
//! factors in units. Sound files that resemble them are read.

use super::*;

const WANTED: ColumnQuantity = ColumnQuantity::Temperature;

fn read_as(layout: &Layout, text: &str) -> Result<Table, DataError> {
    parse(
        "t.csv",
        text.as_bytes(),
        layout,
        &[Wanted::of(WANTED, None, None)],
    )
}

fn in_utc() -> Layout {
    Layout {
        zone: Some("UTC".into()),
        wording: Wording::Flag,
        ..Layout::default()
    }
}

fn read_text(text: &str) -> Result<Table, DataError> {
    read_as(&in_utc(), text)
}

/// The file with this header and these rows.
fn file(header: &str, rows: impl IntoIterator<Item = String>) -> String {
    let rows: Vec<String> = rows.into_iter().collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

/// The year, month, day and hour this many hours after the beginning of 2023.
fn date(hours: usize) -> [usize; 4] {
    const LENGTHS: [usize; 12] = [31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut day = hours / 24 % 365;
    let mut month = 0;
    while day >= LENGTHS[month] {
        day -= LENGTHS[month];
        month += 1;
    }
    [2023 + hours / 24 / 365, month + 1, day + 1, hours % 24]
}

fn iso([year, month, day, hour]: [usize; 4]) -> String {
    format!("{year}-{month:02}-{day:02} {hour:02}:00")
}

/// A temperature with a daily and a yearly cycle and some weather.
fn celsius(hours: usize) -> f64 {
    let t = hours as f64;
    let weather = (t * 0.037).sin() + 0.3 * (t * 1.7).sin();
    10.0 - 9.0 * (t * 7.17e-4).cos() - 4.0 * (t * 0.2618).cos() + 2.0 * weather
}

fn row(hours: usize) -> String {
    format!("{},{:.2}", iso(date(hours)), celsius(hours))
}

/// What a spreadsheet that takes the month first does to a date.
fn exchanged([year, month, day, hour]: [usize; 4]) -> [usize; 4] {
    match day <= 12 {
        true => [year, day, month, hour],
        false => [year, month, day, hour],
    }
}

#[test]
fn dates_that_a_spreadsheet_exchanged_are_refused() {
    let german =
        |[year, month, day, hour]: [usize; 4]| format!("{day:02}.{month:02}.{year} {hour:02}:00");
    let zulu = |date| iso(date).replace(' ', "T") + ":00Z";
    let forms: [&dyn Fn([usize; 4]) -> String; 3] = [&iso, &german, &zulu];
    for (from, hours, every) in [
        (0, 14, 1),
        (0, 75, 6),
        (40, 30, 1),
        (0, 365, 3),
        (100, 500, 6),
    ] {
        for form in forms {
            let rows = (24 * from..24 * (from + hours)).step_by(every);
            let text = |of: fn([usize; 4]) -> [usize; 4]| {
                let row = |hours| format!("{},{:.2}", form(of(date(hours))), celsius(hours));
                file("time,temperature_degC", rows.clone().map(row))
            };
            let dates = Some(DateOrder::DayMonthYear);
            let read = |text: &str| read_as(&Layout { dates, ..in_utc() }, text);
            let sound = read(&text(|date| date)).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(sound.repairs.sentences().len(), 0);
            let error = read(&text(exchanged)).unwrap_err();
            let says = "in order only if day and month are exchanged";
            assert!(
                error.problem.contains(says),
                "{from} {hours} {every}: {error}"
            );
        }
    }
}

/// Files that were joined in any order, rows that are late, and single rows elsewhere are sorted.
#[test]
fn rows_out_of_order_that_were_not_misread_are_sorted() {
    let head = "time,temperature_degC";
    let year = || (0..24 * 365).collect::<Vec<usize>>();
    let months = |order: [usize; 12]| {
        let of = |month: usize| {
            year()
                .into_iter()
                .filter(move |hours| date(*hours)[1] == month)
        };
        order.into_iter().flat_map(of).collect::<Vec<usize>>()
    };
    let late = year()
        .chunks(10)
        .flat_map(|ten| [&ten[1..], &ten[..1]].concat())
        .collect();
    let mut single = year();
    single.swap(100, 4000);
    let backlog = (0..500).flat_map(|i| [500 + 3 * i, 501 + 3 * i, 502 + 3 * i, i]);
    for (what, order) in [
        (
            "alphabetical months",
            months([4, 8, 12, 2, 1, 7, 6, 3, 5, 11, 10, 9]),
        ),
        (
            "the last month first",
            months([12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1]),
        ),
        ("descending", year().into_iter().rev().collect()),
        ("every tenth row late", late),
        ("two rows exchanged", single),
        ("a backlog between live rows", backlog.collect()),
        ("overlapping files", (0..1000).chain(800..2000).collect()),
    ] {
        let table = read_text(&file(head, order.iter().map(|i| row(*i))));
        let column = table
            .unwrap_or_else(|error| panic!("{what}: {error}"))
            .columns
            .swap_remove(0);
        let is_right = |(i, (time, value)): (usize, (&f64, &f64))| {
            *time == 3600.0 * i as f64 && (value - celsius(i)).abs() < 0.006
        };
        let mut samples = column.times.iter().zip(&column.values).enumerate();
        assert!(samples.all(is_right), "{what}");
    }
}

/// A clock that was set back by 20 days, and two series one after the other, with times between
/// those of the first.
#[test]
fn interleaved_rows_without_a_label_are_refused() {
    let row = |hours: f64, value: f64| format!("{hours},{value:.2}");
    let set_back = |i: usize| i as f64 - if i < 1000 { 0.0 } else { 480.3 };
    let twice = |i: usize| if i < 500 { i as f64 } else { i as f64 - 499.9 };
    for times in [set_back, twice] {
        let rows = (0..1000)
            .chain(1000..1900)
            .map(|i| row(times(i), celsius(i)));
        let rows: Vec<String> = rows.collect();
        let error =
            read_as(&Layout::default(), &file("time_h,temperature_degC", rows)).unwrap_err();
        assert!(
            error
                .problem
                .contains("rows lie between rows from elsewhere"),
            "{error}"
        );
        assert!(
            error.line.is_none() && error.remedy.contains("one series"),
            "{error}"
        );
    }
    let times: Vec<f64> = (0..1900).map(|i| 3600.0 * set_back(i)).collect();
    let values: Vec<f64> = (0..1900).map(celsius).collect();
    let error = arrays(&[(WANTED, &times, &values)], &Layout::default()).unwrap_err();
    assert!(
        error
            .problem
            .contains("rows lie between rows from elsewhere"),
        "{error}"
    );
}

/// Every half hour, sensor `k` reports this many seconds after the one before, with its own level
/// and every `lost`-th row missing.
fn long_form(sensors: &[&str], stagger: usize, lost: usize) -> Vec<String> {
    let row = |i: usize| {
        let (cycle, k) = (i / sensors.len(), i % sensors.len());
        let seconds = 1800 * cycle + stagger * k;
        let value = celsius(cycle / 2) + 3.0 * k as f64;
        format!("{},{seconds},{value:.2}", sensors[k])
    };
    (0..300)
        .filter(|i| i * 7919 % 101 % lost != 1)
        .map(row)
        .collect()
}

#[test]
fn interleaved_series_are_refused_with_their_column() {
    let head = "sensor,time_s,temperature_degC";
    let refused = |rows: Vec<String>, says: &str| {
        let error = read_as(&Layout::default(), &file(head, rows)).expect_err(says);
        let problem = "its rows belong to several series, which column `sensor` distinguishes: ";
        assert_eq!(error.problem, format!("{problem}{says}"), "{error}");
    };
    for lost in [5, 1000] {
        for stagger in [0, 7, 30, 600] {
            refused(long_form(&["T1", "T2"], stagger, lost), "`T1`, `T2`");
            refused(long_form(&["1", "2", "3"], stagger, lost), "`1`, `2`, `3`");
        }
        refused(long_form(&["a", "b"], 900, lost), "`a`, `b`");
    }
    // One series after the other.
    let mut rows = long_form(&["T1", "T2"], 30, 1000);
    rows.sort();
    refused(rows, "`T1`, `T2`");
}

#[test]
fn labels_that_alternate_with_the_time_are_no_sensors() {
    let week = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
    type Label<'a> = &'a dyn Fn(usize) -> String;
    let of: [(&str, usize, Label); 7] = [
        ("hours", 3, &|i| (i % 24).to_string()),
        ("slot", 3, &|i| format!("S{}", i / 3 % 8)),
        ("weekday", 24, &|i| week[i / 24 % 7].into()),
        ("half", 12, &|i| {
            if i % 24 < 12 {
                "AM".into()
            } else {
                "PM".into()
            }
        }),
        ("flag", 1, &|i| {
            if i * 7919 % 101 < 30 {
                "ok".into()
            } else {
                "".into()
            }
        }),
        ("battery", 1, &|i| format!("12.{}", i * 7919 % 101 % 3)),
        ("sensor", 1, &|i| {
            if i < 200 { "T1".into() } else { "T2".into() }
        }),
    ];
    for (name, every, label) in of {
        let rows = (0..400)
            .map(|i| i * every)
            .map(|i| format!("{},{}", row(i), label(i)));
        let table = read_text(&file(&format!("time,temperature_degC,{name}"), rows));
        let table = table.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(table.columns[0].values.len(), 400, "{name}");
    }
    // Working days only, whose steps are uneven.
    let days = (0..400).filter(|day| day % 7 < 5);
    let rows = days.map(|day| format!("{},{}", row(24 * day), week[day % 7]));
    read_text(&file("time,temperature_degC,weekday", rows))
        .unwrap_or_else(|error| panic!("{error}"));
}

/// Ten degrees in each part, in its own unit.
#[test]
fn a_second_header_changes_the_unit() {
    let parts = |of: &[&str]| {
        let part = |(i, (head, cell)): (usize, (&str, &str))| {
            format!("{head}\n2023-01-0{} 00:00,{cell}\n", i + 1)
        };
        let parts = of
            .iter()
            .map(|part| part.split_once('|').unwrap_or((part, "")))
            .enumerate();
        parts.map(part).collect::<String>()
    };
    let [celsius, fahrenheit] = ["time,temperature_degC|10", "time,temperature_degF|50"];
    let (kelvin, below) = (
        "Time,Temperature [K]|283.15",
        "time,temperature_degC\n,degF|50",
    );
    let tenths = "time,temperature_degC\n,0.1 degC|100";
    for of in [
        &[celsius, fahrenheit, kelvin][..],
        &[celsius, fahrenheit, celsius],
        &[kelvin, fahrenheit, "time,Temperature [K]|283.15"],
        &["time,temperature\n,degC|10", "time,temperature\n,degF|50"],
        &[
            "time,temperature\n,degC|10",
            "time,temperature\n,0.1 degC|100",
        ],
        &[celsius, celsius],
    ] {
        for skip_bad in [false, true] {
            let table = read_as(
                &Layout {
                    skip_bad,
                    ..in_utc()
                },
                &parts(of),
            );
            let values = &table
                .unwrap_or_else(|error| panic!("{of:?}: {error}"))
                .columns[0]
                .values;
            let first = values[0];
            assert!(
                values.iter().all(|value| (value - first).abs() < 1e-9),
                "{of:?}: {values:?}"
            );
        }
    }
    for (of, says) in [
        (
            &[celsius, "time,air|10"][..],
            "a second header, with other columns",
        ),
        (
            &[celsius, "temperature_degC,time|10"],
            "a second header, with other columns",
        ),
        (
            &["time,temperature|10", fahrenheit],
            "another unit than that of the first",
        ),
        (&[celsius, below], "a different unit from its column"),
        (&[celsius, tenths], "a different unit from its column"),
    ] {
        for skip_bad in [false, true] {
            let error = read_as(
                &Layout {
                    skip_bad,
                    ..in_utc()
                },
                &parts(of),
            );
            match error {
                Err(error) => assert!(error.problem.contains(says), "{of:?}: {error}"),
                Ok(table) => panic!("{of:?} {:?}", table.columns[0].values),
            }
        }
    }
}

/// The values of two cells below these lines, in degrees Celsius or metres.
fn values(of: ColumnQuantity, head: &str, cells: [&str; 2]) -> Result<Vec<f64>, DataError> {
    let text = format!("{head}\n0;{}\n1;{}\n", cells[0], cells[1]);
    let read = parse(
        "t.csv",
        text.as_bytes(),
        &Layout::default(),
        &[Wanted::of(of, None, None)],
    );
    Ok(read?.columns.swap_remove(0).values)
}

#[test]
fn a_scale_is_applied_and_a_factor_is_refused() {
    let displacement = ColumnQuantity::Displacement;
    for (of, head, cells, is) in [
        (
            WANTED,
            "time_s;temp (1/10 degC)",
            ["155", "-20"],
            [15.5, -2.0],
        ),
        (
            WANTED,
            "time_s;temp [0,1 \u{b0}C]",
            ["155", "-20"],
            [15.5, -2.0],
        ),
        (WANTED, "time_s;temp (0.1 *C)", ["155", "-20"], [15.5, -2.0]),
        (
            WANTED,
            "time_s;temp\ns;1/100 K",
            ["1550", "200"],
            [15.5, 2.0],
        ),
        (WANTED, ";degF\ntime_s;temp", ["59.9", "28.4"], [15.5, -2.0]),
        (
            WANTED,
            "s;[degF]\ntime_s;temp",
            ["59.9", "28.4"],
            [15.5, -2.0],
        ),
        (
            displacement,
            "time_s;disp (1/100 mm)",
            ["155", "-20"],
            [1.55e-3, -0.2e-3],
        ),
        (
            displacement,
            "time_s;disp 0.01mm",
            ["155", "-20"],
            [1.55e-3, -0.2e-3],
        ),
        (
            displacement,
            "s;um\ntime_s;disp",
            ["155", "-20"],
            [155e-6, -20e-6],
        ),
        (
            displacement,
            "time_s;disp_10um",
            ["155", "-20"],
            [1.55e-3, -0.2e-3],
        ),
    ] {
        let found = values(of, head, cells).unwrap_or_else(|error| panic!("{head}: {error}"));
        assert!(
            found.iter().zip(is).all(|(a, b)| (a - b).abs() < 1e-12),
            "{head}: {found:?}"
        );
    }
    for (of, head) in [
        (WANTED, "time_s;temp x10"),
        (WANTED, "time_s;temp_degC_x10"),
        (WANTED, "time_s;Temp [\u{b0}C x 10]"),
        (WANTED, "time_s;temp (\u{b0}C*10)"),
        (WANTED, "time_s;temp (degC/10)"),
        (WANTED, "time_s;temperature in tenths of degC"),
        (WANTED, "time_s;temp (0.1 x \u{b0}C)"),
        (WANTED, "time_s;temp\ns;degC*10"),
        (WANTED, "s;degC x10\ntime_s;temp"),
        (displacement, "time_s;disp mm \u{d7}100"),
        (displacement, "time_s;disp (10^-2 mm)"),
    ] {
        let error = values(of, head, ["155", "-20"]).expect_err(head);
        assert!(
            error.problem.contains("contains a factor"),
            "{head}: {error}"
        );
        assert!(error.remedy.contains("as `unit`"), "{head}: {error}");
    }
    // These are names.
    for head in [
        "time_s;tempmax10 degC",
        "time_s;temp 10 cm degC",
        "time_s;temp, \u{b0}C (S/N: 20x10)",
    ] {
        values(WANTED, head, ["15", "16"]).unwrap_or_else(|error| panic!("{head}: {error}"));
    }
}

/// A spreadsheet writes `########` for a number or a date that is wider than its column.
#[test]
fn cells_that_were_too_narrow_are_no_comments() {
    let head = "time,temperature_degC\n2023-03-04 05:00,12\n";
    for (row, line) in [
        ("########,13", 3),
        ("2023-03-04 06:00,#####", 3),
        ("# note\n###,13", 4),
    ] {
        let text = format!("{head}{row}\n2023-03-04 07:00,13\n");
        let error = read_text(&text).expect_err(row);
        assert!(
            error.problem.starts_with("was too narrow") && error.line == Some(line),
            "{error}"
        );
    }
    let text = format!("{head}#### note ####\n# a, b\n2023-03-04 07:00,13\n");
    assert_eq!(read_text(&text).map(|table| table.rows), Ok(2));
}

/// What the files need besides the names of their columns is said with the names.
#[test]
fn all_problems_of_both_files_are_reported_at_once() {
    let air =
        "Pfeiler 2\nZeitpunkt;Luft [\u{b0}C]\n01.03.2025 00:00;12,05\n02.03.2025 00:10;12,11\n";
    let sensor = "Datum;Uhrzeit;Weg\n01.03.2025;00:00:00;1,25\n02.03.2025;00:10:00;1,5\n";
    let source = |wording| ColumnSource {
        layout: Layout {
            wording,
            ..Layout::default()
        },
        ..ColumnSource::default()
    };
    let read = |air_source: &ColumnSource, sensor_source: &ColumnSource| {
        let origin = Some(Origin::Text("t.csv", air));
        BearingData::read(
            Origin::Text("z.csv", sensor),
            origin,
            air_source,
            sensor_source,
        )
    };
    let (mut of_air, mut of_sensor) = (source(Wording::TemperatureFlag), source(Wording::Flag));
    let error = read(&of_air, &of_sensor).unwrap_err().to_string();
    for fix in [
        "`--temperature-time Zeitpunkt`",
        "`--temperature 'Luft [\u{b0}C]'`",
        "`--temperature-dates dmy`",
        "`--displacement Weg`",
        "`--displacement-unit mm`",
        "`--dates dmy`",
        "`--zone UTC`",
    ] {
        assert!(error.contains(fix), "{fix}: {error}");
    }
    of_air.layout.time = Some("Zeitpunkt".into());
    of_air.column = Some("Luft".into());
    of_air.layout.zone = Some("+01:00".into());
    (of_sensor.column, of_sensor.unit) = (Some("Weg".into()), Some("mm".into()));
    of_sensor.layout.zone = Some("Europe/Berlin".into());
    for of in [&mut of_air, &mut of_sensor] {
        of.layout.dates = Some(DateOrder::DayMonthYear);
    }
    let data = read(&of_air, &of_sensor).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(data.temperature.times, data.displacement.times);
    assert_eq!(data.displacement.values, [1.25e-3, 1.5e-3]);
}
