//! Links between the pages.

use super::markdown::{Page, root};
use std::path::{Path, PathBuf};

/// The targets of the links in a line: `[text](target)`.
fn targets(line: &str) -> Vec<&str> {
    line.split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target)
        .collect()
}

/// The anchor that a heading gets: lower case, spaces as hyphens, no punctuation.
fn anchor(heading: &str) -> String {
    let kept = heading
        .to_lowercase()
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
        .collect::<String>();
    kept.replace(' ', "-")
}

#[test]
fn repository_links_lead_to_existing_files_and_headings() {
    let mut followed = 0;
    for page in Page::all() {
        for target in page
            .prose()
            .flat_map(targets)
            .filter(|target| !target.contains("://"))
        {
            let (path, heading) = target.split_once('#').unwrap_or((target, ""));
            let folder = page.path.parent().expect("a file is in a folder");
            let linked = if path.is_empty() {
                page.path.clone()
            } else {
                folder.join(path)
            };
            assert!(
                root().join(&linked).exists(),
                "{}: {target}",
                page.path.display()
            );
            if !heading.is_empty() {
                let is_there = Page::read(&linked)
                    .headings()
                    .any(|other| anchor(other) == heading);
                assert!(
                    is_there,
                    "{}: {target}: no such heading",
                    page.path.display()
                );
            }
            followed += 1;
        }
    }
    assert!(followed > 40, "links are recognised: {followed}");
}

/// The files that a page links to, relative to the root of the repository, once for each link.
fn linked(from: &str) -> Vec<PathBuf> {
    let page = Page::read(from);
    let folder = page.path.parent().expect("a file is in a folder");
    let target = |target: &str| {
        let path = target.split('#').next().expect("a path");
        match path.strip_prefix("../") {
            Some(above) => folder.parent().unwrap_or(folder).join(above),
            None => folder.join(path),
        }
    };
    page.prose()
        .flat_map(targets)
        .filter(|target| !target.contains("://"))
        .map(target)
        .collect()
}

/// The overview of the documentation lists every page, and the contents of its site list every page
/// exactly once. A page that is missing there would not be part of the site.
#[test]
fn every_page_is_in_the_overview_and_once_in_the_contents() {
    let (overview, contents) = (linked("docs/README.md"), linked("docs/SUMMARY.md"));
    let frame = ["README.md", "docs/README.md", "docs/SUMMARY.md"];
    for page in Page::all()
        .into_iter()
        .filter(|page| !frame.iter().any(|path| page.path == Path::new(path)))
    {
        assert!(
            overview.contains(&page.path),
            "{} is not in docs/README.md",
            page.path.display()
        );
        let times = contents.iter().filter(|path| **path == page.path).count();
        assert_eq!(times, 1, "{} in docs/SUMMARY.md", page.path.display());
    }
    assert!(
        linked("README.md").contains(&"docs/README.md".into()),
        "README.md leads to the overview"
    );
}
