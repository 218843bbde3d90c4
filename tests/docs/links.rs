//! Links from page to page.

use super::markdown::{Page, root};

/// The targets of the links in a line: `[text](target)`.
fn targets(line: &str) -> Vec<&str> {
    line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

/// The anchor that a heading gets: lower case, spaces as hyphens, no punctuation.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
    kept.replace(' ', "-")
}

#[test]
fn every_link_to_the_repository_leads_to_a_file_and_to_a_heading_in_it() {
    let mut followed = 0;
    for page in Page::all() {
        for target in page.prose().flat_map(targets).filter(|target| !target.contains("://")) {
            let (path, heading) = target.split_once('#').unwrap_or((target, ""));
            let folder = page.path.parent().expect("a file is in a folder");
            let linked = if path.is_empty() { page.path.clone() } else { folder.join(path) };
            assert!(root().join(&linked).exists(), "{}: {target}", page.path.display());
            if !heading.is_empty() {
                let is_there = Page::read(&linked).headings().any(|other| anchor(other) == heading);
                assert!(is_there, "{}: {target}: no such heading", page.path.display());
            }
            followed += 1;
        }
    }
    assert!(followed > 40, "links are recognised: {followed}");
}

#[test]
fn every_page_is_linked_from_the_readme() {
    let readme = Page::read("README.md");
    let linked: Vec<&str> = readme.prose().flat_map(targets).collect();
    for page in Page::all().into_iter().filter(|page| page.path != readme.path) {
        let path = page.path.to_str().expect("ASCII");
        assert!(linked.iter().any(|target| target.split('#').next() == Some(path)), "{path} is not in README.md");
    }
}
