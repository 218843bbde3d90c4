//! The rows of a CSV file: its separator, and the place of each row.

use super::error::{DataError, quoted};
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};
use std::borrow::Cow;

/// The end of the remedy for a bad line. The reader of tables replaces it.
pub(super) const OR_SKIP: &str = "{or skip}";

/// What is wrong with a cell of `########`, and the remedy.
pub(super) const TOO_NARROW: (&str, &str) = (
    "was too narrow for its content when a spreadsheet saved the file",
    "widen the column in the spreadsheet, and export the file again",
);

/// Reads the rows of a CSV file one at a time, and holds the current row.
pub(super) struct CsvRows<'a> {
    file: &'a str,
    bytes: &'a [u8],
    reader: Reader,
    separator: u8,
    /// Number of columns up to the last one with a name, and up to the last one that is wanted.
    width: usize,
    named: usize,
    wanted: usize,
    /// Byte offsets: `first` is where the rows begin, `at` is how far the file has been read,
    /// `row_offset` is where the search for the current row began.
    first: usize,
    at: usize,
    row_offset: usize,
    cells: Vec<u8>,
    ends: Vec<usize>,
    fields: usize,
}

impl<'a> CsvRows<'a> {
    /// The rows from this byte on, with this separator. Lines that begin with `#` are skipped if
    /// they are comments.
    pub fn at(
        file: &'a str,
        bytes: &'a [u8],
        offset: usize,
        separator: u8,
        skips_comments: bool,
    ) -> Self {
        let comment = Some(b'#').filter(|_| skips_comments);
        let reader = ReaderBuilder::new()
            .delimiter(separator)
            .comment(comment)
            .build();
        CsvRows {
            file,
            bytes,
            reader,
            separator,
            width: 0,
            named: 0,
            wanted: 0,
            first: offset,
            at: offset,
            row_offset: offset,
            cells: vec![0; 1 << 12],
            ends: vec![0; 64],
            fields: 0,
        }
    }

    /// The cells of the next row as texts; none at the end of the file.
    pub fn texts(&mut self) -> Option<Vec<String>> {
        self.read().then(|| {
            (0..self.fields)
                .map(|field| String::from_utf8_lossy(self.cell(field)).into_owned())
                .collect()
        })
    }

    /// From here on, a row has at least this number of cells, and at most that of the row just
    /// read, which names them.
    pub fn below(mut self, wanted: usize) -> Self {
        self.wanted = wanted;
        (self.width, self.first) = (self.fields, self.at);
        self.named = (0..self.fields)
            .rfind(|field| !self.cell(*field).is_empty())
            .map_or(0, |last| last + 1);
        self
    }

    /// From here on every row has this number of cells, and there is no row of names.
    pub fn numbered(mut self, width: usize) -> Self {
        (self.width, self.named, self.wanted) = (width, width, width);
        self
    }

    /// The error of a row whose number of cells differs from that of the header.
    fn uneven(&self) -> DataError {
        let (found, named) = (self.fields, self.named);
        let problem = format!(
            "{found} cell{}, but the header names {named} column{}, separated by {}",
            if found == 1 { "" } else { "s" },
            if named == 1 { "" } else { "s" },
            name_of(self.separator)
        );
        let remedy = if found > named && self.separator == b',' {
            "correct the line; if its decimals have commas, separate all columns by semicolons"
        } else {
            "check for another separator, an unclosed quotation mark or a truncated line"
        };
        let remedy = format!("{remedy}{OR_SKIP}");
        DataError::file(self.file, problem, remedy).line(self.line(self.place()))
    }

    /// Read one row into `cells` and `ends`; false at the end of the file.
    fn read(&mut self) -> bool {
        self.row_offset = self.at;
        let (mut written, mut fields) = (0, 0);
        loop {
            let (cells, ends) = (&mut self.cells[written..], &mut self.ends[fields..]);
            let (result, read, wrote, ended) =
                self.reader.read_record(&self.bytes[self.at..], cells, ends);
            self.at += read;
            written += wrote;
            fields += ended;
            match result {
                // Calling the reader again with empty input marks the end of the file.
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

    /// Whether numbers may have a decimal comma: always, as between semicolons, or only in quoted
    /// cells, where it may also separate thousands.
    pub fn commas_are_decimal(&self) -> bool {
        self.separator != b','
    }

    /// Read the next row; false at the end. A row may lack unwanted cells at its end, unless it is
    /// the last line and was cut off.
    pub fn next(&mut self) -> Result<bool, DataError> {
        let before = self.fields;
        if !self.read() {
            return Ok(false);
        }
        let is_last = self.at == self.bytes.len();
        let is_quote = |byte: &&u8| **byte == b'"';
        let quotes = || {
            self.bytes[self.row_offset..]
                .iter()
                .filter(is_quote)
                .count()
        };
        let is_cut = is_last
            && (self.fields < before.min(self.named) && !self.bytes.ends_with(b"\n")
                || quotes() % 2 == 1);
        let is_even = self.fields >= self.wanted
            && !is_cut
            && (self.width..self.fields).all(|field| self.cell(field).is_empty());
        if is_even {
            Ok(true)
        } else {
            Err(self.uneven())
        }
    }

    /// Continue after the first line of the current row: an unclosed quotation mark joins many
    /// lines into one row.
    pub fn leave_out_line(&mut self) {
        let start = row_start(self.bytes, self.row_offset);
        let length = self.bytes[start..].iter().position(|byte| *byte == b'\n');
        self.at = length.map_or(self.at, |length| self.at.min(start + length + 1));
        self.fields = self.named;
        self.reader.reset();
    }

    /// The line of the first row whose first cell a spreadsheet has filled with `#` because it was
    /// too narrow. Such a row looks like a comment.
    pub fn too_narrow(&self) -> Option<u64> {
        let mut at = self.first;
        for line in self.bytes[self.first..].split(|byte| *byte == b'\n') {
            let hashes = line.iter().take_while(|byte| **byte == b'#').count();
            if hashes >= 3 && line.get(hashes) == Some(&self.separator) {
                return Some(line_at(self.bytes, at));
            }
            at += line.len() + 1;
        }
        None
    }

    /// Go back to before the first row.
    pub fn rewind(&mut self) {
        self.reader.reset();
        self.at = self.first;
    }

    /// A cell of the current row, without the blanks around it; empty beyond the last one.
    pub fn cell(&self, field: usize) -> &[u8] {
        if field >= self.fields {
            return b"";
        }
        let start = if field == 0 { 0 } else { self.ends[field - 1] };
        self.cells[start..self.ends[field]].trim_ascii()
    }

    /// The place of the current row, to be given to [`CsvRows::line`] later.
    pub fn place(&self) -> u32 {
        self.row_offset as u32
    }

    /// The number of the line, from 1, on which the row at this place begins.
    pub fn line(&self, place: u32) -> u64 {
        line_at(self.bytes, row_start(self.bytes, place as usize))
    }
}

/// The text with tabs in place of blanks, if its last line has only blanks between cells.
pub(super) fn with_tabs(text: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    let last = text
        .trim_ascii()
        .rsplit(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default();
    if last.iter().any(|byte| b",;\t".contains(byte)) {
        return text;
    }
    let lines = text.split(|byte| *byte == b'\n').map(|line| {
        let cells = line
            .split(u8::is_ascii_whitespace)
            .filter(|cell| !cell.is_empty());
        cells.collect::<Vec<_>>().join(&b'\t')
    });
    Cow::Owned(lines.collect::<Vec<_>>().join(&b'\n'))
}

/// The number of the line, from 1, that holds this byte.
pub(super) fn line_at(bytes: &[u8], offset: usize) -> u64 {
    1 + bytes[..offset]
        .iter()
        .filter(|byte| **byte == b'\n')
        .count() as u64
}

/// The byte offset of the next row, after empty lines and comments.
fn row_start(bytes: &[u8], from: usize) -> usize {
    let mut at = from;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'\n' | b'\r' => at += 1,
            b'#' => {
                at += bytes[at..]
                    .iter()
                    .position(|byte| *byte == b'\n')
                    .unwrap_or(bytes.len() - at)
            }
            _ => break,
        }
    }
    at
}

/// The separator of a line of names: a semicolon or a tab if the line contains one, else a comma.
/// Characters within quoted names do not count.
pub(super) fn separator(line: &[u8]) -> u8 {
    let mut quoted = false;
    let bare: Vec<u8> = line
        .iter()
        .copied()
        .filter(|byte| {
            quoted ^= *byte == b'"';
            !quoted
        })
        .collect();
    [b';', b'\t']
        .into_iter()
        .find(|byte| bare.contains(byte))
        .unwrap_or(b',')
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
    let named: Vec<String> = header
        .iter()
        .filter(|name| !name.is_empty())
        .map(|name| format!("`{}`", quoted(name.as_bytes())))
        .collect();
    let more = if named.len() > MOST {
        format!(" and {} more", named.len() - MOST)
    } else {
        String::new()
    };
    named[..named.len().min(MOST)].join(", ") + &more
}
