use super::Table;
use contactbench_terms::number::wrap;

const GAP: usize = 2;
/// Text columns shrink to this width before number columns shrink.
const NARROW: usize = 12;

impl Table {
    /// Formats the table for a terminal of this many columns. Cells wrap until the table fits. The
    /// head is left out if it is empty.
    pub fn plain(&self, width: usize) -> String {
        let heads: Vec<Vec<String>> =
            self.columns.iter().map(|column| vec![column.head()]).collect();
        let titled = self.columns.iter().any(|column| !column.head().is_empty());
        let body = self.rows.iter().map(|row| row.iter().map(|cell| cell.lines()).collect());
        let rows: Vec<Vec<Vec<String>>> = titled.then_some(heads).into_iter().chain(body).collect();
        let widths = self.widths(&rows, width);
        let mut out = String::new();
        if !self.title.is_empty() {
            wrap(&self.title, width).into_iter().for_each(|line| out += &(line + "\n"));
        }
        for row in &rows {
            let cells: Vec<Vec<String>> = row
                .iter()
                .zip(&widths)
                .map(|(lines, &width)| lines.iter().flat_map(|line| wrap(line, width)).collect())
                .collect();
            for k in 0..cells.iter().map(Vec::len).max().unwrap_or(0) {
                let mut text = String::new();
                for ((cell, &width), column) in cells.iter().zip(&widths).zip(&self.columns) {
                    let piece = cell.get(k).map_or("", String::as_str);
                    text += &match column.right {
                        true => format!("{piece:>width$}"),
                        false => format!("{piece:<width$}"),
                    };
                    text.extend([' '; GAP]);
                }
                out += &(text.trim_end().to_string() + "\n");
            }
        }
        out
    }

    /// Returns the width of each column: that of its longest line, narrowed until all columns fit.
    /// The widest text column shrinks first while it is wider than [`NARROW`], then the widest of
    /// all. Words are split only as a last resort.
    fn widths(&self, rows: &[Vec<Vec<String>>], limit: usize) -> Vec<usize> {
        let lines = |column: usize| rows.iter().filter_map(move |row| row.get(column)).flatten();
        // Formatting accepts widths of 16 bits.
        let most = usize::from(u16::MAX);
        let longest = |column| lines(column).map(|line| line.chars().count().min(most)).max();
        let words = |column| lines(column).flat_map(|line| line.split_whitespace());
        let word = |column| words(column).map(|word| word.chars().count()).max().unwrap_or(0);
        let mut widths: Vec<usize> =
            (0..self.columns.len()).map(|k| longest(k).unwrap_or(0)).collect();
        let whole: Vec<usize> = (0..self.columns.len()).map(word).collect();
        let room = limit.saturating_sub(GAP * self.columns.len().saturating_sub(1));
        while widths.iter().sum::<usize>() > room.max(self.columns.len()) {
            let widest = |may: &dyn Fn(usize) -> bool| {
                (0..widths.len()).filter(|&k| may(k)).max_by_key(|&k| widths[k])
            };
            let at = widest(&|k| !self.columns[k].right && widths[k] > NARROW.max(whole[k]))
                .or_else(|| widest(&|k| widths[k] > whole[k]))
                .or_else(|| widest(&|_| true));
            match at {
                Some(at) if widths[at] > 1 => widths[at] -= 1,
                _ => break,
            }
        }
        widths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_of_any_length_is_formatted() {
        let long = "m".repeat(100_000);
        let table: Table = Table::of("", [&*long]).left("name", |name| name.to_string()).into();
        assert_eq!(table.plain(usize::MAX).matches('m').count(), 100_001);
    }
}
