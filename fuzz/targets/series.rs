//! Reads a CSV file of a measured temperature. The result is a table whose times ascend and whose
//! numbers are finite, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_data::{ColumnQuantity, DateOrder, Layout, Name, Wanted, parse};
use stickslip::model::Series;

fuzz_target!(|bytes: &[u8]| {
    // The first byte decides the layout and the longest gap.
    let (how, bytes) = bytes.split_first().unwrap_or((&0, &[]));
    let zone = [None, Some("UTC"), Some("Europe/Berlin"), Some("nowhere")][usize::from(how % 4)];
    let max_gap = (how & 4 != 0).then_some(21_600.0);
    let column = if how & 8 != 0 { Name::Exactly("temperature_degC") } else { Name::Beginning("temperature") };
    let layout = Layout {
        time: (how & 16 != 0).then(|| "time".to_string()),
        zone: zone.map(String::from),
        dates: (how & 32 != 0).then_some(DateOrder::DayMonthYear),
        skip: (how & 64 != 0).then_some(1),
        ..Layout::default()
    };
    let wanted = Wanted { column, quantity: ColumnQuantity::Temperature, unit: None, max_gap };
    if let Ok(table) = parse("fuzz.csv", bytes, &layout, &[wanted]) {
        let column = &table.columns[0];
        assert!(column.times.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(column.values.iter().all(|value| value.is_finite()));
        let _ = Series::new(column.times.clone(), column.values.clone());
    }
});
