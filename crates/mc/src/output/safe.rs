//! Makes text safe for a terminal: no character in it moves the cursor, changes colours or reverses
//! the direction of the text, and lines have a limited length.
//!
//! Titles, keys, units and file names come from outside the program and may contain anything. So
//! everything that is printed goes through this module.

/// The maximum number of characters in a line for people.
const LINE: usize = 1000;

/// Text for people: unsafe characters are escaped and long lines are cut.
pub fn text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        match line.char_indices().nth(LINE) {
            Some((end, _)) if line[end..].trim_end().chars().nth(1).is_some() => {
                escape(&line[..end], &mut out);
                out.push_str(" ...");
                out.extend(line.ends_with('\n').then_some('\n'));
            }
            _ => escape(line, &mut out),
        }
    }
    out
}

/// Text for programs: unsafe characters are escaped and nothing is cut. The escapes are those that
/// JSON and TOML share.
pub fn data(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    escape(text, &mut out);
    out
}

fn escape(text: &str, out: &mut String) {
    for c in text.chars() {
        match u32::from(c) {
            _ if !is_unsafe(c) => out.push(c),
            code @ ..=0xffff => out.push_str(&format!("\\u{code:04x}")),
            code => out.push_str(&format!("\\U{code:08x}")),
        }
    }
}

/// Control characters, marks that change the order of text or hide it, and characters that only
/// look like the end of a line.
fn is_unsafe(c: char) -> bool {
    c.is_control() && c != '\n' && c != '\t'
        || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
        || matches!(c, '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_moves_the_cursor_or_turns_the_text_around() {
        assert_eq!(text("plain \u{b5}m\tx\n"), "plain \u{b5}m\tx\n");
        assert_eq!(
            text("\u{1b}[2J\u{7}\r\u{9b}"),
            "\\u001b[2J\\u0007\\u000d\\u009b"
        );
        assert_eq!(
            data("a\u{202e}b\u{2066}c\u{e0041}"),
            "a\\u202eb\\u2066c\\U000e0041"
        );
    }

    #[test]
    fn lines_for_people_end() {
        let long = "x".repeat(800_000);
        let shown = text(&format!("{long}\nshort\n{long}"));
        assert!(
            shown.len() < 2100 && shown.contains(" ...\nshort\n"),
            "{}",
            shown.len()
        );
        assert_eq!(data(&long), long);
        let exact = "y".repeat(LINE) + "\n";
        assert_eq!(text(&exact), exact);
    }
}
