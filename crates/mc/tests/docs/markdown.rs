//! The pages of the repository, and the parts of a Markdown page.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The root of the repository.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A page and its path in the repository.
pub struct Page {
    /// The path, relative to the root of the repository.
    pub path: PathBuf,
    pub text: String,
}

impl Page {
    /// The page at this path, relative to the root.
    pub fn read(path: impl Into<PathBuf>) -> Page {
        let path = path.into();
        let text = fs::read_to_string(root().join(&path))
            .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Page { path, text }
    }

    /// All pages: those at the root, in `docs/` and in `docs/bearing/`.
    pub fn all() -> Vec<Page> {
        let mut paths: Vec<PathBuf> = ["", "docs", "docs/bearing"]
            .iter()
            .flat_map(|folder| {
                fs::read_dir(root().join(folder)).expect("a folder of the repository")
            })
            .map(|entry| entry.expect("readable").path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
            .map(|path| {
                path.strip_prefix(root())
                    .expect("below the root")
                    .to_path_buf()
            })
            .collect();
        paths.sort();
        assert!(paths.len() > 8, "the pages are where they were");
        paths.into_iter().map(Page::read).collect()
    }

    /// The lines outside of code blocks.
    pub fn prose(&self) -> impl Iterator<Item = &str> {
        let mut is_fenced = false;
        self.text.lines().filter(move |line| {
            let is_fence = line.starts_with("```");
            is_fenced ^= is_fence;
            !is_fence && !is_fenced && !line.starts_with("    ")
        })
    }

    /// The lines inside of code blocks.
    pub fn code(&self) -> impl Iterator<Item = &str> {
        let mut is_fenced = false;
        self.text.lines().filter(move |line| {
            let is_fence = line.starts_with("```");
            is_fenced ^= is_fence;
            !is_fence && (is_fenced || line.starts_with("    "))
        })
    }

    /// The headings without their marks.
    pub fn headings(&self) -> impl Iterator<Item = &str> {
        self.prose()
            .filter(|line| line.starts_with('#'))
            .map(|line| line.trim_start_matches('#').trim())
    }

    /// The texts between backticks in the prose.
    pub fn spans(&self) -> Vec<&str> {
        self.prose().flat_map(spans).collect()
    }

    /// The rows, without headings, of every table whose first heading is this one.
    pub fn rows(&self, first_heading: &str) -> Vec<Vec<String>> {
        let lines: Vec<&str> = self.prose().collect();
        let mut rows = Vec::new();
        for (at, line) in lines.iter().enumerate() {
            if line.starts_with('|')
                && (at == 0 || !lines[at - 1].starts_with('|'))
                && cells(line)[0] == first_heading
            {
                let body = lines[at..]
                    .iter()
                    .skip(2)
                    .take_while(|line| line.starts_with('|'));
                rows.extend(body.map(|line| cells(line)));
            }
        }
        assert!(
            !rows.is_empty(),
            "{}: no table whose first heading is {first_heading}",
            self.path.display()
        );
        rows
    }

    /// The part of the page under the second-level heading that begins with this text, up to the
    /// next such heading.
    pub fn section(&self, heading: &str) -> Page {
        let start = self.text.find(&format!("\n{heading}"));
        let start =
            start.unwrap_or_else(|| panic!("{}: no heading {heading}", self.path.display())) + 1;
        let rest = &self.text[start..];
        let end = rest.find("\n## ").map_or(rest.len(), |end| end + 1);
        Page {
            path: self.path.clone(),
            text: rest[..end].to_string(),
        }
    }
}

/// Two lists of names must be equal. The failure shows the names that are in one of them only.
#[track_caller]
pub fn same(listed: &BTreeSet<String>, of_code: &BTreeSet<String>) {
    let missing: Vec<_> = of_code.difference(listed).collect();
    let stale: Vec<_> = listed.difference(of_code).collect();
    assert!(
        missing.is_empty() && stale.is_empty(),
        "not documented: {missing:?}; documented and not there: {stale:?}"
    );
}

/// The texts between backticks in a line.
pub fn spans(line: &str) -> Vec<&str> {
    line.split('`').skip(1).step_by(2).collect()
}

/// The names between backticks in a cell.
pub fn names(cell: &str) -> Vec<String> {
    spans(cell).into_iter().map(String::from).collect()
}

/// The cells of a row. `\|` is a bar inside a cell.
fn cells(line: &str) -> Vec<String> {
    let line = line
        .trim()
        .trim_start_matches('|')
        .trim_end_matches('|')
        .replace("\\|", "\u{0}");
    line.split('|')
        .map(|cell| cell.trim().replace('\u{0}', "|"))
        .collect()
}
