//! Text that is put into SVG and HTML.

/// A text with the escapes of XML, which are those of HTML: between tags, and in an attribute
/// between quotation marks of either kind, it stays text. Characters that XML does not allow, such
/// as NUL, become replacement characters.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn nothing_in_a_text_ends_an_attribute_an_element_or_a_line() {
        assert_eq!(
            escaped("' onmouseover='alert(1)"),
            "&#39; onmouseover=&#39;alert(1)"
        );
        assert_eq!(escaped("\"<&>"), "&quot;&lt;&amp;&gt;");
        assert_eq!(
            escaped("a\u{0}b\u{7f}\r\n\t\u{ffff}"),
            "a\u{fffd}b\u{fffd}\u{fffd}\n\t\u{fffd}"
        );
    }
}
