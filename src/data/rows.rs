//! Rows of cells, and a CSV file as such: its separator, its header, and the place of each row.

use super::error::{DataError, quoted};
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

/// Reads the rows of a table one at a time, and holds the current row.
pub(super) trait Rows {
    /// Whether numbers may have a decimal comma.
    fn may_have_commas(&self) -> bool;

    /// Read the next row; false at the end.
    fn next(&mut self) -> Result<bool, DataError>;

    /// A cell of the current row, without the blanks around it.
    fn cell(&self, field: usize) -> &[u8];

    /// The place of the current row, to be given to [`Rows::line`] later.
    fn place(&self) -> u32;

    /// The number of the line, from 1, on which the row at this place begins.
    fn line(&self, place: u32) -> u64;
}

/// The rows of a CSV file.
pub(super) struct CsvRows<'a> {
    file: &'a str,
    bytes: &'a [u8],
    reader: Reader,
    separator: u8,
    /// Number of columns.
    width: usize,
    /// Byte offsets: `at` is how far the file has been read, `row_offset` is where the search for
    /// the current row began.
    at: usize,
    row_offset: usize,
    cells: Vec<u8>,
    ends: Vec<usize>,
    fields: usize,
}

impl<'a> CsvRows<'a> {
    /// Open a file and read its header. The reader then stands before the first row.
    pub fn open(file: &'a str, bytes: &'a [u8]) -> Result<(Self, Vec<String>), DataError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let foreign = |what: &str, remedy| DataError::file(file, format!("it is {what}"), remedy);
        if bytes.starts_with(b"\x89HDF\r\n\x1a\n") {
            return Err(foreign("an HDF5 file, not CSV", "write its columns as CSV"));
        }
        if bytes.starts_with(b"PK\x03\x04") {
            return Err(foreign("a spreadsheet or another zip archive, not CSV", "export the sheet as CSV"));
        }
        if bytes.starts_with(b"\xff\xfe")
            || bytes.starts_with(b"\xfe\xff")
            || bytes[..bytes.len().min(512)].contains(&0)
        {
            return Err(foreign("not UTF-8 text (UTF-16, or binary)", "save it as CSV in UTF-8"));
        }
        let separator = separator(&bytes[row_start(bytes, 0)..]);
        let reader = ReaderBuilder::new().delimiter(separator).comment(Some(b'#')).build();
        let (cells, ends) = (vec![0; 1 << 12], vec![0; 64]);
        let mut rows =
            CsvRows { file, bytes, reader, separator, width: 0, at: 0, row_offset: 0, cells, ends, fields: 0 };
        if !rows.read() {
            return Err(foreign("empty", "give a CSV file whose first line names its columns"));
        }
        let header: Vec<String> =
            (0..rows.fields).map(|field| String::from_utf8_lossy(rows.cell(field)).into_owned()).collect();
        if header.iter().all(|name| name.is_empty() || name.replace(',', ".").parse::<f64>().is_ok()) {
            let problem = "its first line holds numbers, where the names of the columns should be".to_string();
            let error = DataError::file(file, problem, "put a line such as `time_s,temperature_degC` before it");
            return Err(error.line(rows.line(rows.place())));
        }
        rows.width = rows.fields;
        Ok((rows, header))
    }

    /// The error of a row that has not as many cells as the header.
    fn uneven(&self) -> DataError {
        let (found, named) = (self.fields, self.width);
        let problem = format!(
            "{found} cell{} where the header names {named} column{}, separated by {}",
            if found == 1 { "" } else { "s" },
            if named == 1 { "" } else { "s" },
            name_of(self.separator)
        );
        let remedy = if found > named && self.separator == b',' {
            "mend the row; if its decimals have commas, separate the columns by semicolons, in the header as well"
        } else {
            "mend the row, and see that every line is separated as the header is; a quotation mark may be left open"
        };
        DataError::file(self.file, problem, remedy).line(self.line(self.place()))
    }

    /// Read one row into `cells` and `ends`; false at the end of the file.
    fn read(&mut self) -> bool {
        self.row_offset = self.at;
        let (mut written, mut fields) = (0, 0);
        loop {
            let (cells, ends) = (&mut self.cells[written..], &mut self.ends[fields..]);
            let (result, read, wrote, ended) = self.reader.read_record(&self.bytes[self.at..], cells, ends);
            self.at += read;
            written += wrote;
            fields += ended;
            match result {
                // Calling the reader again with empty input tells it that the file has ended.
                ReadRecordResult::InputEmpty => {}
                ReadRecordResult::OutputFull => self.cells.resize(2 * self.cells.len(), 0),
                ReadRecordResult::OutputEndsFull => self.ends.resize(2 * self.ends.len(), 0),
                ReadRecordResult::Record => {
                    self.fields = fields;
                    return true;
                }
                ReadRecordResult::End => return false,
            }
        }
    }
}

impl Rows for CsvRows<'_> {
    fn may_have_commas(&self) -> bool {
        self.separator != b','
    }

    fn next(&mut self) -> Result<bool, DataError> {
        if !self.read() {
            return Ok(false);
        }
        let is_even = self.fields >= self.width && (self.width..self.fields).all(|field| self.cell(field).is_empty());
        if is_even { Ok(true) } else { Err(self.uneven()) }
    }

    fn cell(&self, field: usize) -> &[u8] {
        let start = if field == 0 { 0 } else { self.ends[field - 1] };
        self.cells[start..self.ends[field]].trim_ascii()
    }

    fn place(&self) -> u32 {
        self.row_offset as u32
    }

    fn line(&self, place: u32) -> u64 {
        let before = &self.bytes[..row_start(self.bytes, place as usize)];
        1 + before.iter().filter(|byte| **byte == b'\n').count() as u64
    }
}

/// The byte offset of the next row, after empty lines and comments.
fn row_start(bytes: &[u8], from: usize) -> usize {
    let mut at = from;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'\n' | b'\r' => at += 1,
            b'#' => at += bytes[at..].iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len() - at),
            _ => break,
        }
    }
    at
}

/// The separator of the header: a semicolon or a tab if the header contains one, else a comma.
/// Characters within quoted names do not count.
fn separator(header: &[u8]) -> u8 {
    let mut quoted = false;
    let line = header.iter().take_while(|byte| **byte != b'\n');
    let bare: Vec<u8> = line
        .copied()
        .filter(|byte| {
            quoted ^= *byte == b'"';
            !quoted
        })
        .collect();
    [b';', b'\t'].into_iter().find(|byte| bare.contains(byte)).unwrap_or(b',')
}

fn name_of(separator: u8) -> &'static str {
    match separator {
        b';' => "semicolons",
        b'\t' => "tabs",
        _ => "commas",
    }
}

/// The names of a header, as a message lists them.
pub(super) fn listed(header: &[String]) -> String {
    const MOST: usize = 20;
    let names: Vec<String> = header.iter().take(MOST).map(|name| format!("`{}`", quoted(name.as_bytes()))).collect();
    let more = if header.len() > MOST { format!(" and {} more", header.len() - MOST) } else { String::new() };
    names.join(", ") + &more
}
