//! Excerpts of a text for messages, of limited length and without invisible characters.

/// Characters of a line that are shown on either side of the place that a message is about.
const AROUND: usize = 80;

/// A line, and carets under some characters of it, `start` characters from its beginning. A long
/// line is cut to their surroundings. Each control character is shown as one other character, so
/// that the carets stay in place; a tab is kept in both lines.
pub fn underlined(line: &str, start: usize, length: usize) -> [String; 2] {
    let from = start.saturating_sub(AROUND);
    let dots = if from > 0 { "..." } else { "" };
    let mut rest = line.chars().skip(from);
    let shown: String = rest.by_ref().take(start - from + 2 * AROUND).collect();
    let end = if rest.next().is_some() { "..." } else { "" };
    let indent: String = shown
        .chars()
        .take(start - from)
        .map(|c| if c == '\t' { '\t' } else { ' ' })
        .collect();
    let carets = "^".repeat(length.clamp(1, 2 * AROUND));
    let shown: String = shown.chars().map(visible).collect();
    [
        format!("{dots}{shown}{end}"),
        format!("{0:1$}{indent}{carets}", "", dots.len()),
    ]
}

/// The beginning of a text, of at most as many characters as any number needs.
pub fn short(text: &str) -> String {
    const LENGTH: usize = 40;
    let dots = if text.chars().nth(LENGTH).is_some() {
        "..."
    } else {
        ""
    };
    text.chars()
        .take(LENGTH)
        .map(visible)
        .chain(dots.chars())
        .collect()
}

/// The character itself, or another one in the place of a control character. A tab is kept.
fn visible(c: char) -> char {
    if c.is_control() && c != '\t' {
        char::REPLACEMENT_CHARACTER
    } else {
        c
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_cut_around_the_carets() {
        let text = |line: &str, start: usize, length: usize| underlined(line, start, length);
        assert_eq!(text("a = 1", 4, 1), ["a = 1", "    ^"]);
        assert_eq!(text("\ta\0b = 1", 3, 1), ["\ta\u{fffd}b = 1", "\t  ^"]);
        let long = format!("{}!?{}", "x".repeat(400_000), "y".repeat(400_000));
        let [line, carets] = text(&long, 400_000, 2);
        assert!(line.len() < 300 && carets.len() < 300, "{line}\n{carets}");
        assert_eq!(line.find("!?"), carets.find("^^"));
        assert!(line.starts_with("...x") && line.ends_with("y..."));
        let [line, carets] = text(&long, 0, 800_002);
        assert!(line.len() < 300 && carets.len() < 300);
    }
}
