//! `mc init`: writes a scenario to start from, with comments on every section.

use crate::arguments::overrides::Overrides;
use crate::output::failure::{Failure, note, print_data, writable};
use crate::report::aligned;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use std::path::{Path, PathBuf};
use stickslip::config::{Override, SHIPPED, Shipped, shipped};
use stickslip_files::store;

/// Arguments of `mc init`.
#[derive(Debug, clap::Args)]
#[command(after_help = help())]
pub struct Arguments {
    /// The shipped scenario to start from
    #[arg(long, value_name = "NAME", default_value = "rho025",
          hide_possible_values = true,
          value_parser = PossibleValuesParser::new(SHIPPED.map(|scenario| scenario.name))
            .try_map(|name| shipped(&name).ok_or("no shipped scenario")))]
    from: &'static Shipped,
    /// Title of the scenario, in one line; sets the key `title`
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    #[command(flatten)]
    overrides: Overrides,
    /// Output file; `-` is standard output [default: NAME.toml]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
}

/// The examples, and the shipped scenarios with their titles.
fn help() -> String {
    let row = |scenario: &Shipped| {
        let title = scenario
            .text
            .lines()
            .find_map(|line| line.strip_prefix("title = "));
        vec![
            format!("  {}", scenario.name),
            title.unwrap_or_default().trim_matches('"').to_string(),
        ]
    };
    format!(
        "{}\n\nShipped scenarios:\n{}",
        include_str!("help/init.txt"),
        aligned(
            &SHIPPED.iter().map(row).collect::<Vec<_>>(),
            &[true; 2],
            "  "
        )
    )
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let start = self.from;
        let title = self
            .title
            .iter()
            .map(|title| Override::text("--title", "title", title));
        let changes: Vec<Override> = self
            .overrides
            .without_goals()?
            .into_iter()
            .chain(title)
            .collect();
        let scenario = start.parse(&changes)?;
        let text = introduction(start.name, start.text, &changes) + "\n" + &scenario.to_template();
        let output = self
            .output
            .clone()
            .unwrap_or_else(|| format!("{}.toml", start.name).into());
        if output == Path::new("-") {
            return print_data(&text);
        }
        // The data files that the scenario names are written next to it.
        let beside = start
            .data
            .iter()
            .map(|(name, text)| (output.with_file_name(name), *text));
        let files: Vec<(PathBuf, &str)> = std::iter::once((output.clone(), text.as_str()))
            .chain(beside)
            .collect();
        files
            .iter()
            .try_for_each(|(path, _)| writable(path, self.force, [""; 0]))?;
        store::write_together(&files, self.force)?;
        files[1..]
            .iter()
            .for_each(|(path, _)| note(&format!("wrote {}", path.display())));
        note(&format!("wrote {0}; next: mc check {0}", output.display()));
        Ok(())
    }
}

/// The comment at the top of the file: that of the shipped scenario if nothing is changed,
/// otherwise a list of the changes.
fn introduction(name: &str, text: &str, changes: &[Override]) -> String {
    if changes.is_empty() {
        return text
            .lines()
            .take_while(|line| line.starts_with('#'))
            .map(|line| format!("{line}\n"))
            .collect();
    }
    let changes: Vec<String> = changes.iter().map(Override::to_string).collect();
    format!(
        "# The shipped scenario {name}, with {}.\n",
        changes.join(" ")
    )
}
