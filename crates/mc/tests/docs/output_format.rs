//! docs/output-format.md lists every attribute and variable of the files that `mc` writes, with its
//! axes, type and unit.

use super::markdown::{Page, names, root, same, spans};
use hdf5::types::{FloatSize, IntSize, TypeDescriptor};
use hdf5::{Dataset, File};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const PAGE: &str = "docs/output-format.md";

/// A row of a table on the page: the description of a variable.
#[derive(Clone, Debug)]
struct Documented {
    axes: Vec<String>,
    kind: String,
    unit: String,
}

/// All variables of the tables by name. If a cell has several names, the row has one type and one
/// unit for all of them, or one for each.
fn documented(page: &Page) -> BTreeMap<String, Documented> {
    let mut all = BTreeMap::new();
    for row in page.rows("Variable") {
        let [name, axes, kind, unit, _] = row.as_slice() else {
            panic!("five cells: {row:?}")
        };
        let names = names(name);
        let each = |cell: &str, i: usize| {
            let parts: Vec<&str> = cell.split(',').map(str::trim).collect();
            if parts.len() == names.len() {
                parts[i].to_string()
            } else {
                cell.to_string()
            }
        };
        // Most variables are real numbers.
        let kind = if kind.is_empty() { "f64" } else { kind };
        let axes: Vec<String> = axes
            .split(", ")
            .filter(|axis| !axis.is_empty())
            .map(String::from)
            .collect();
        for (i, name) in names.iter().enumerate() {
            let row = Documented {
                axes: axes.clone(),
                kind: each(kind, i),
                unit: each(unit, i),
            };
            assert!(
                all.insert(name.to_string(), row).is_none(),
                "{name} is listed twice"
            );
        }
    }
    all
}

/// The dimensions that a heading names and that have no values of their own.
fn bare_dimensions(page: &Page) -> BTreeSet<String> {
    let dimensions = page
        .headings()
        .filter_map(|heading| heading.split_once("dimension"));
    dimensions
        .flat_map(|(_, names)| spans(names.split(", with").next().unwrap_or(names)))
        .map(String::from)
        .collect()
}

fn kind(dataset: &Dataset) -> &'static str {
    match dataset
        .dtype()
        .and_then(|kind| kind.to_descriptor())
        .expect("a type")
    {
        TypeDescriptor::Float(FloatSize::U8) => "f64",
        TypeDescriptor::Unsigned(IntSize::U8) => "u64",
        TypeDescriptor::Unsigned(IntSize::U4) => "u32",
        TypeDescriptor::Unsigned(IntSize::U1) => "u8",
        TypeDescriptor::Integer(IntSize::U1) => "i8",
        TypeDescriptor::VarLenUnicode => "text",
        other => panic!(
            "{}: a type that the page has no word for: {other}",
            dataset.name()
        ),
    }
}

fn text(location: &hdf5::Location, name: &str) -> Option<String> {
    let value = location
        .attr(name)
        .ok()?
        .read_scalar::<hdf5::types::VarLenUnicode>()
        .ok()?;
    Some(value.as_str().to_string())
}

/// The `units` attribute for a unit on the page, if the labels are s, m, N and K.
fn udunits(unit: &str) -> Option<&'static str> {
    Some(match unit {
        "" | "flags" => return None,
        "1" => "1",
        "time" | "s" => "s",
        "length" => "m",
        "length/time" => "m s-1",
        "length^2" => "m2",
        "1/length" => "m-1",
        "1/time" => "s-1",
        "time/length" => "m-1 s",
        "time/length^2" => "m-2 s",
        "length^2/time" => "m2 s-1",
        "length^2/time^2" => "m2 s-2",
        "length^2 time" => "m2 s",
        "force" => "N",
        "force length" => "N m",
        "temperature" => "K",
        other => panic!("a unit that is not of the model: {other}"),
    })
}

/// The row of a variable. An interval, or an end of one, which the page leaves out, is as the
/// variable that it is of; an interval has the axis `bound` before.
fn row(rows: &BTreeMap<String, Documented>, name: &str) -> Option<Documented> {
    let ends = || {
        name.strip_suffix("_low")
            .or_else(|| name.strip_suffix("_high"))
    };
    if let Some(of) = name.strip_suffix("_interval").and_then(|of| rows.get(of)) {
        return Some(Documented {
            axes: [vec!["bound".into()], of.axes.clone()].concat(),
            ..of.clone()
        });
    }
    rows.get(name).or_else(|| rows.get(ends()?)).cloned()
}

/// Checks that each variable of a file is as the page says. Returns the names of the variables
/// that are listed.
fn check(file: &File, page: &Page) -> BTreeSet<String> {
    let (rows, bare) = (documented(page), bare_dimensions(page));
    let members = file.member_names().expect("a root group");
    for name in &members {
        let dataset = file
            .dataset(name)
            .expect("everything is a variable of the root group");
        let Some(Documented {
            axes,
            kind: documented,
            unit,
        }) = row(&rows, name)
        else {
            assert!(
                bare.contains(name),
                "{name} is in a file, and not in {PAGE}"
            );
            continue;
        };
        assert_eq!(kind(&dataset), documented, "type of {name}");
        let lengths: Vec<usize> = axes
            .iter()
            .map(|axis| file.dataset(axis).expect("an axis").size())
            .collect();
        assert_eq!(dataset.shape(), lengths, "axes of {name}");
        assert_eq!(
            text(&dataset, "units").as_deref(),
            udunits(&unit),
            "unit of {name}"
        );
    }
    members
        .into_iter()
        .filter(|name| rows.contains_key(name) || bare.contains(name))
        .collect()
}

/// What a file says of a variable: its name in full, and what its flags mean.
fn meaning(dataset: &Dataset) -> String {
    let name = text(dataset, "long_name").expect("every variable has one");
    let Some(meanings) = text(dataset, "flag_meanings") else {
        return name.replace('|', "\\|");
    };
    let values = dataset.attr("flag_values").expect("beside the meanings");
    let values = values.read_raw::<i8>().expect("flags");
    let flags = values.iter().zip(meanings.split(' '));
    let flags: Vec<String> = flags
        .map(|(value, meaning)| format!("{value} {}", meaning.replace('_', " ")))
        .collect();
    format!("{name}: {}", flags.join(", "))
}

/// The tables of variables are generated: a row for each variable, in the order of the page, which
/// ends with what the files say of it. With `REWRITE_PAGES` set they are written, and else compared.
fn generate(page: &Page, files: &[File]) {
    let rows = documented(page);
    let of = |name: &str| {
        let Documented { axes, kind, unit } = &rows[name];
        let held = files.iter().find_map(|file| file.dataset(name).ok());
        let kind = if kind == "f64" { "" } else { kind };
        let cells = [
            format!("`{name}`"),
            axes.join(", "),
            kind.to_string(),
            unit.clone(),
            meaning(&held.expect("it is in a file")),
        ];
        let cells = cells.map(|cell| match cell.is_empty() {
            true => " ".to_string(),
            false => format!(" {cell} "),
        });
        format!("|{}|", cells.join("|"))
    };
    let mut is_table = false;
    let mut lines = Vec::new();
    for line in page.text.lines() {
        is_table = line.starts_with("| Variable |") || is_table && line.starts_with('|');
        match is_table && line.starts_with("| `") {
            true => lines.extend(
                names(line.split(" | ").next().unwrap_or(line))
                    .iter()
                    .map(|name| of(name)),
            ),
            false => lines.push(line.to_string()),
        }
    }
    let generated = lines.join("\n");
    if std::env::var_os("REWRITE_PAGES").is_some() {
        let path = root().join(PAGE);
        let whole = std::fs::read_to_string(&path).expect("the page");
        let whole = whole.replace(page.text.trim_end(), generated.trim_end());
        std::fs::write(path, whole).expect("written");
    } else {
        assert!(
            generated.trim_end() == page.text.trim_end(),
            "{PAGE} is not as the variables are declared; `REWRITE_PAGES=1 cargo test --release -p \
             stickslip-mc --test docs output_format -- --test-threads 1` writes it"
        );
    }
}

const UNITS: [&str; 8] = [
    "--set",
    "units.time=s",
    "--set",
    "units.length=m",
    "--set",
    "units.force=N",
    "--set",
    "units.temperature=K",
];

/// Writes a file with `mc`. A run of which every path diverges fails, but writes a file as well.
fn written(folder: &Path, name: &str, arguments: &[&str]) -> File {
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    let arguments: Vec<String> = arguments
        .iter()
        .map(|argument| argument.replace("scenarios", scenarios))
        .collect();
    let arguments: Vec<&str> = arguments
        .iter()
        .map(String::as_str)
        .chain(UNITS)
        .chain(["-o", name])
        .collect();
    let output = super::command::mc(folder, &arguments);
    File::open(folder.join(name))
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&output.stderr)))
}

/// The scenario `shaken.toml` with the input of `ag.csv`.
fn shaken(folder: &Path) {
    std::fs::write(folder.join("ag.csv"), "time_s,ag (g)\n0,0\n10,1\n").expect("written");
    let shaken = "oscillator = { mass = 1, stiffness = 1, dilatation = 0 }\nfriction = { static = 1, dynamic = 1 }\n\
                  input.ag.file = \"ag.csv\"\nforce.expression = \"ag\"\ninitial.displacement = 0\nscheme.kind = \"event-driven\"\n";
    std::fs::write(folder.join("shaken.toml"), shaken).expect("written");
}

/// Files in which together everything occurs that a run can write: records, units, lost paths, a
/// resolution, pairs, a part, a run that was ended, a measured temperature with a bearing, and the
/// fewest paths for a bias of the step, and an input.
fn runs(folder: &Path) -> Vec<File> {
    let record = ["record.events=true", "record.trajectories=7"]
        .map(|set| ["--set", set])
        .concat();
    let asked = ["laws", "density", "spectrum", "energy"].map(|name| format!("record.{name}=true"));
    let asked: Vec<&str> = asked
        .iter()
        .flat_map(|set| ["--set", set.as_str()])
        .collect();
    let levels = ["--set", "statistics.levels=[1.0]", "--until", "120"];
    let on_request = [
        &["run", "scenarios/rho025.toml", "--paths", "300"][..],
        &asked,
        &levels,
    ]
    .concat();
    let everything = [
        &["run", "scenarios/rho025.toml", "--paths", "300"][..],
        &record,
    ]
    .concat();
    let diverging = [
        "run",
        "scenarios/rho025.toml",
        "--paths",
        "3",
        "--step",
        "0.5",
        "--set",
        "initial.displacement=1e3",
    ];
    let unresolved = [
        "run",
        "scenarios/equal-friction.toml",
        "--scheme",
        "event-driven",
        "--paths",
        "2",
    ];
    let late = [
        "run",
        "scenarios/rho025.toml",
        "--paths",
        "2",
        "--set",
        "statistics.after=30",
    ];
    let pairs = [
        "run",
        "scenarios/rho025.toml",
        "--paths",
        "4",
        "--set",
        "ensemble.antithetic=true",
    ];
    let part = [
        "run",
        "scenarios/rho025.toml",
        "--paths",
        "600",
        "--part",
        "2/3",
    ];
    shaken(folder);
    let ended = [
        "run",
        "scenarios/rho025.toml",
        "--until",
        "stick_duration_mean < 20%",
    ];
    vec![
        written(folder, "everything.h5", &everything),
        written(folder, "on-request.h5", &on_request),
        written(folder, "diverging.h5", &diverging),
        written(folder, "unresolved.h5", &unresolved),
        written(folder, "late.h5", &late),
        written(folder, "pairs.h5", &pairs),
        written(folder, "part.h5", &part),
        written(folder, "ended.h5", &ended),
        written(folder, "measured.h5", &["run", "scenarios/bridge.toml"]),
        written(folder, "shaken.h5", &["run", "shaken.toml", "--paths", "1"]),
        written(
            folder,
            "biased.h5",
            &["run", "scenarios/rho025.toml", "--paths", "768"],
        ),
    ]
}

fn of_runs() -> Page {
    let page = Page::read(PAGE);
    let (runs, _) = page
        .text
        .split_once("## The file of `mc trade`")
        .expect("runs first, then trades and sweeps");
    Page {
        text: runs.to_string(),
        path: page.path,
    }
}

#[test]
fn variables_of_a_run_are_listed_with_axes_type_and_unit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = of_runs();
    let files = runs(folder.path());
    let found: BTreeSet<String> = files.iter().flat_map(|file| check(file, &page)).collect();
    let listed: BTreeSet<String> = documented(&page)
        .into_keys()
        .chain(bare_dimensions(&page))
        .collect();
    same(&listed, &found);
    generate(&page, &files);
}

#[test]
fn attributes_of_a_run_are_listed_with_types_and_constants() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = of_runs();
    let files = runs(folder.path());
    let mut found = BTreeSet::new();
    let mut constants = 0;
    for row in page.rows("Attribute") {
        for name in names(&row[0]) {
            let holders: Vec<&File> = files
                .iter()
                .filter(|file| file.attr(&name).is_ok())
                .collect();
            assert!(!holders.is_empty(), "{name} is in no file");
            for file in holders {
                let attribute = file.attr(&name).expect("it is there");
                let is_text = attribute
                    .dtype()
                    .and_then(|kind| kind.to_descriptor())
                    .expect("a type")
                    == TypeDescriptor::VarLenUnicode;
                assert_eq!(is_text, row[1] == "text", "type of {name}");
                // A meaning that consists of a value in backticks only is that value.
                if let Some(value) = row[2]
                    .strip_prefix('`')
                    .and_then(|rest| rest.strip_suffix('`'))
                    .filter(|value| !value.contains('`'))
                {
                    assert_eq!(text(file, &name).as_deref(), Some(value), "{name}");
                    constants += 1;
                }
            }
            found.insert(name);
        }
    }
    assert!(
        constants >= 3,
        "constant attributes are recognised: {constants}"
    );
    let written: BTreeSet<String> = files
        .iter()
        .flat_map(|file| file.attr_names().expect("attributes"))
        .collect();
    same(&found, &written);
}

#[test]
fn every_variable_and_attribute_of_a_trade_is_listed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = Page::read(PAGE).section("## The file of `mc trade`");
    let file = written(
        folder.path(),
        "trade.h5",
        &["trade", "scenarios/shaw.toml", "--budget", "1s"],
    );
    same(
        &documented(&page).into_keys().collect(),
        &check(&file, &page),
    );
    let prose = page.spans();
    for attribute in file.attr_names().expect("attributes") {
        assert!(
            prose.contains(&attribute.as_str()),
            "attribute {attribute} of a trade is not in {PAGE}"
        );
    }
    generate(&page, std::slice::from_ref(&file));
    for constant in ["format_name", "format_version"] {
        let value = text(&file, constant).expect("it is there");
        assert!(
            page.text.contains(&format!("`{constant}` is `{value}`")),
            "{constant} is {value}"
        );
    }
}

/// The axes of a sweep are those of its design, which the page writes as `...`.
#[test]
fn every_variable_and_attribute_of_a_sweep_is_listed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = Page::read(PAGE).section("## The file of `mc sweep`");
    let small = [
        "--paths",
        "40",
        "--until",
        "10",
        "--set",
        "time.output_step=10",
    ];
    let crossed = [
        "--vary",
        "rho=temperature.noise.intensity=0.1,0.2",
        "--vary",
        "friction.static=1.2,1.3",
    ];
    let keys = ["--elasticity", "friction.static,friction.dynamic"];
    let of = |name: &str, more: &[&str]| {
        written(
            folder.path(),
            name,
            &[&["sweep", "scenarios/rho025.toml"], &small[..], more].concat(),
        )
    };
    let files = [
        (of("grid.h5", &crossed), "rho, f_s"),
        (of("zip.h5", &[&crossed[..], &["--zip"]].concat()), "point"),
        (of("elasticity.h5", &keys), "point"),
        (
            of(
                "cycles.h5",
                &[
                    "--vary",
                    "rho=temperature.noise.intensity=0,0.1",
                    "--vary",
                    "friction.static=1.2,1.3",
                ],
            ),
            "rho, f_s",
        ),
    ];
    let axes = BTreeSet::from(["rho".to_string(), "f_s".to_string()]);
    let (mut found, mut attributes) = (BTreeSet::new(), BTreeSet::new());
    for (file, dimensions) in &files {
        let text = page
            .text
            .replace("...,", &format!("{dimensions},"))
            .replace("| ... |", &format!("| {dimensions} |"));
        let own = axes
            .iter()
            .filter(|axis| file.link_exists(axis))
            .map(|axis| {
                let along = if dimensions.contains("rho") {
                    axis
                } else {
                    "point"
                };
                format!("| `{axis}` | {along} | f64 | | value of the key |\n")
            });
        let table = "\n| Variable | Axes | Type | Unit | Meaning |\n|---|---|---|---|---|\n";
        let page = Page {
            text: text + table + &own.collect::<String>(),
            path: page.path.clone(),
        };
        found.extend(check(file, &page));
        attributes.extend(file.attr_names().expect("attributes"));
    }
    shaken(folder.path());
    let records = [
        "sweep",
        "shaken.toml",
        "--vary",
        "record=input.ag.file=ag.csv",
        "--paths=1",
    ];
    let records = written(folder.path(), "records.h5", &records);
    let own = "\n| Variable | Axes | Type | Unit | Meaning |\n|---|---|---|---|---|\n| `record` | record | text | | |\n";
    let text = page
        .text
        .replace("...,", "record,")
        .replace("| ... |", "| record |")
        + own;
    let inputs = Page::read(PAGE).section("### Inputs");
    let page_of_records = Page {
        text: text + &inputs.text,
        path: page.path.clone(),
    };
    found.extend(check(&records, &page_of_records));
    found.remove("record");
    found.retain(|name| !name.starts_with("input"));
    let listed: BTreeSet<String> = documented(&page).into_keys().collect();
    same(&listed, &found.difference(&axes).cloned().collect());
    let files: Vec<File> = files
        .into_iter()
        .map(|(file, _)| file)
        .chain([records])
        .collect();
    generate(&page, &files);
    let prose = page.spans();
    for attribute in attributes {
        assert!(
            prose.contains(&attribute.as_str()),
            "attribute {attribute} of a sweep is not in {PAGE}"
        );
    }
}
