//! A requested table, made once: what CSV, data dictionary, Markdown, terminal and page show is in one value, and none of them
//! knows what layout it has.
//!
//! A layout finds its cells ([`Layout::cells`]), declares the columns of the tidy form ([`Layout::columns`]) and sets the
//! cells for readers ([`Layout::set`]): side by side as numbers for the page, as lines of text for Markdown and the terminal.

use super::columns::{Columns, of_factor};
use super::{Findings, TableRequest};
use crate::stats::compatibility::{Agreement, Printed, rules};
use crate::table::{Column, Table, Value};
use serde::{Serialize, Serializer};

/// A table as it is shown to people and programs.
#[derive(Debug, Clone, PartialEq)]
pub struct Exhibit {
    /// Name of its files.
    pub id: String,
    /// Its title.
    pub title: String,
    /// What the columns of the tidy form say, in their order.
    pub columns: Vec<Column>,
    /// The tidy form: one row a cell.
    pub tidy: Table,
    /// The answer to the question that it asks, in sentences, where it asks one.
    pub answer: Option<String>,
    /// The same for readers.
    pub set: Set,
}

/// The cells of a table as readers see them.
#[derive(Debug, Clone, PartialEq)]
pub struct Set {
    /// The cells side by side, as numbers.
    pub grid: Grid,
    /// The lines as a document has room for them; `None` where they are those of the tidy form.
    pub print: Option<Table>,
    /// The lines as a terminal has room for them.
    pub lines: Lines,
    /// How the lines of a terminal are to be read, in clauses.
    pub legend: Vec<String>,
    /// How many cells the lines leave out, which the tidy form has.
    pub more: usize,
}

/// Lines of a terminal.
#[derive(Debug, Clone, PartialEq)]
pub enum Lines {
    /// One a row of `table`. The first `keys` columns name a line; the columns `left` stand to the left.
    All {
        /// What stands in them.
        table: Table,
        /// How many columns name a line.
        keys: usize,
        /// Columns of words.
        left: Vec<usize>,
    },
    /// Too many to read, which other tables sum up: so many cells, by these factors.
    Elsewhere {
        /// Cells with trials.
        cells: usize,
        /// What tells them apart.
        by: String,
    },
}

/// Cells side by side, ours above what they are compared with.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Quantity and unit of the cells: `distance travelled (m)`.
    pub quantity: String,
    /// What stands in a cell's second line: `paper`, where it is the paper's number.
    pub beside: &'static str,
    /// Where that is from.
    pub source: Source,
    /// Decimals the cells are shown with.
    pub decimals: u8,
    /// Whether each cell is of as many trials as the experiment has of a condition, so that the title says how many.
    pub of_trials: bool,
    /// What the rows are: `environment, coverage`.
    pub row_header: String,
    /// What the columns are, one name each.
    pub columns: Vec<String>,
    /// The rows, each with one cell per column.
    pub rows: Vec<GridRow>,
}

/// Where the numbers come from that ours stand beside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Source {
    /// There are none.
    #[default]
    Nowhere,
    /// The paper, in the part of it that the manifest cites.
    Paper,
    /// Elsewhere.
    Other(&'static str),
}

impl Source {
    /// Returns the paper where numbers of its are named.
    pub(super) fn of(published: Option<&String>) -> Self {
        published.map_or(Self::Nowhere, |_| Self::Paper)
    }
}

/// One row of a grid.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GridRow {
    /// Its name: `90 %`.
    pub label: String,
    /// Its cells.
    pub cells: Vec<GridCell>,
}

/// One cell of a grid: ours and the paper's.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GridCell {
    /// What we found; `None` where there is nothing, for the reason that `agreement` says.
    pub ours: Option<Measured>,
    /// Difference of our mean to our baseline's (percent); `None` for the baseline itself.
    pub difference_percent: Option<f64>,
    /// What the paper prints.
    pub published: Option<Measured>,
    /// The difference to its baseline that the paper prints (percent).
    pub published_difference_percent: Option<f64>,
    /// How the two agree, or why they cannot be compared.
    #[serde(serialize_with = "by_name")]
    pub agreement: Agreement,
    /// From 5 to 95 % of what each value of a factor has by itself, where the cell takes them together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band: Option<[f64; 2]>,
}

/// A mean over trials, in the unit of its table.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Measured {
    /// The mean.
    pub mean: f64,
    /// The standard deviation, where there is one.
    pub sd: Option<f64>,
    /// Number of trials behind it, where known.
    pub n: Option<u64>,
}

/// Writes the name, by which the page looks up mark and words.
fn by_name<S: Serializer>(agreement: &Agreement, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(agreement.name())
}

/// A layout of tables, as a manifest asks for it.
pub trait Layout {
    /// What one row of the tidy form is made of.
    type Cell;

    /// Finds the cells, in the order of the tidy form; `tables` are all that the manifest asks for.
    fn cells(&self, findings: &Findings<'_>, tables: &[TableRequest]) -> Vec<Self::Cell>;

    /// Declares the columns of the tidy form.
    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, Self::Cell>;

    /// Sets the cells for readers.
    fn set(&self, cells: &[Self::Cell], findings: &Findings<'_>) -> Set;

    /// Answers the question that the table asks, in sentences; `None` where it asks none.
    fn answer(&self, _cells: &[Self::Cell]) -> Option<String> {
        None
    }
}

impl Exhibit {
    /// Makes the table that `request` asks for in the layout `wanted`.
    pub(super) fn of<L: Layout>(
        request: &TableRequest,
        wanted: &L,
        findings: &Findings<'_>,
        tables: &[TableRequest],
    ) -> Self {
        let cells = wanted.cells(findings, tables);
        let declared = wanted.columns(findings);
        let tidy = declared.table(&cells);
        // A factor that is called like a column of numbers would be taken for one; its column comes first in the table.
        let known = |column: Column| of_factor(findings.factors, &column.name).unwrap_or(column);
        let mut set = wanted.set(&cells, findings);
        if set.print.is_none() && !findings.labels.is_empty() {
            set.print = Some(labelled(&tidy, findings));
        }
        Self {
            id: request.id.clone(),
            title: request.title.clone(),
            columns: declared.described().into_iter().map(known).collect(),
            tidy,
            answer: wanted.answer(&cells),
            set,
        }
    }

    /// Returns the lines as a document has room for them.
    pub fn print(&self) -> &Table {
        self.set.print.as_ref().unwrap_or(&self.tidy)
    }

    /// Says what the marks in it mean: the methods that occur; `None` where nothing is compared.
    pub fn rules(&self) -> Option<String> {
        let cells = self.set.grid.rows.iter().flat_map(|row| &row.cells);
        rules(cells.map(|cell| cell.agreement))
    }
}

impl Lines {
    /// Shows all lines of `table`.
    pub fn all(table: Table, keys: usize, left: impl IntoIterator<Item = usize>) -> Self {
        Self::All { table, keys, left: left.into_iter().collect() }
    }
}

impl From<Printed> for Measured {
    fn from(printed: Printed) -> Self {
        Self { mean: printed.value, sd: printed.sd, n: printed.n }
    }
}

/// Cells of which so many stand abreast in a line, each line named by its first one.
pub(super) struct Abreast<'a, C, L> {
    /// The cells, line by line.
    pub cells: &'a [C],
    /// How many are a line.
    pub of: usize,
    /// What names a line.
    pub label: L,
}

impl<C, L: Fn(&C) -> Vec<String>> Abreast<'_, C, L> {
    fn lines(&self) -> impl Iterator<Item = (Vec<String>, &[C])> {
        self.cells.chunks(self.of.max(1)).map(|line| ((self.label)(&line[0]), line))
    }

    /// Returns the lines as a table of `columns`, in which each cell has `texts`.
    pub(super) fn table<T: IntoIterator<Item = String>>(
        &self,
        columns: Vec<String>,
        texts: impl Fn(&C) -> T,
    ) -> Table {
        let mut table = Table::new(columns);
        for (label, line) in self.lines() {
            table.push(
                label.into_iter().chain(line.iter().flat_map(&texts)).map(Value::from).collect(),
            );
        }
        table
    }

    /// Returns the lines as rows of a grid, in which each cell is shown as `cell` says.
    pub(super) fn rows(&self, cell: impl Fn(&C) -> GridCell) -> Vec<GridRow> {
        let row = |(label, line): (Vec<String>, &[C])| GridRow {
            label: label.join(", "),
            cells: line.iter().map(&cell).collect(),
        };
        self.lines().map(row).collect()
    }
}

/// Returns the `tidy` form with what readers see for factors and their values.
fn labelled(tidy: &Table, findings: &Findings<'_>) -> Table {
    let labels = findings.labels;
    let is_factor = |name: &str| findings.factors.iter().any(|factor| factor.name == name);
    let heads = tidy.columns.iter().map(|name| labels.factor(name).to_owned());
    let mut table = Table::new(heads);
    for row in &tidy.rows {
        let shown = |(name, value): (&String, &Value)| match value {
            Value::Text(text) if is_factor(name) => labels.value(name, text).into(),
            other => other.clone(),
        };
        table.push(tidy.columns.iter().zip(row).map(shown).collect());
    }
    table
}
