//! Lengths of time as users write them.

use jiff::{Span, SpanRelativeTo, Unit};

/// Convert `"6h"`, `"1d 12h"` or `"90min"` to seconds; `None` if the text is not a length of time
/// above zero. A day has 24 hours.
///
/// ```
/// use stickslip_data::seconds;
///
/// assert_eq!([seconds("6h"), seconds("1d 12h"), seconds("-1h"), seconds("soon")], [Some(21_600.0), Some(129_600.0), None, None]);
/// ```
pub fn seconds(text: &str) -> Option<f64> {
    let span: Span = text.trim().parse().ok()?;
    let seconds = span
        .total((Unit::Second, SpanRelativeTo::days_are_24_hours()))
        .ok()?;
    (seconds > 0.0).then_some(seconds)
}
