//! The draws as CSV: written by `reenact vary --joint`, read from beside a manifest.

use super::draws::{Draw, Found, Multiverse, Verdict};
use crate::claims::verdict::Judgement;
use crate::digest::Sha256Digest;
use crate::table::{Table, Value};

/// The columns before the settings.
const FIRST: [&str; 5] = ["draw", "seed", "trials", "refused", "records"];

/// What stands in the column `draw` of the run at the values that the manifest chose.
const CHOSEN: &str = "chosen";

/// How many draws, settings and claims a table may have, multiplied: what it takes to explain them is in proportion.
pub const MOST_CELLS: usize = 4_000_000;

/// What a column of a claim says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prefix {
    /// `verdict:ID`: the verdict.
    Verdict,
    /// `estimate:ID`: the size of what it was judged by.
    Estimate,
}

/// Returns what the column `name` says of a claim, and of which one; `None` for other columns.
pub fn prefixed(name: &str) -> Option<(Prefix, &str)> {
    let verdict = name.strip_prefix("verdict:").map(|claim| (Prefix::Verdict, claim));
    verdict.or_else(|| Some((Prefix::Estimate, name.strip_prefix("estimate:")?)))
}

/// Why a text is no table of a multiverse.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct MultiverseError(String);

/// What the header line says.
struct Header {
    settings: Vec<String>,
    claims: Vec<String>,
}

impl Header {
    fn of(columns: &[String]) -> Option<Self> {
        let rest = columns.strip_prefix(&FIRST.map(str::to_owned)[..])?;
        let settings = rest.iter().take_while(|name| prefixed(name).is_none());
        let settings: Vec<String> = settings.cloned().collect();
        let mut claims = Vec::new();
        for pair in rest[settings.len()..].chunks(2) {
            match pair {
                [verdict, estimate] => match (prefixed(verdict), prefixed(estimate)) {
                    (Some((Prefix::Verdict, claim)), Some((Prefix::Estimate, same)))
                        if claim == same =>
                    {
                        claims.push(claim.to_owned());
                    }
                    _ => return None,
                },
                _ => return None,
            }
        }
        Some(Self { settings, claims })
    }

    fn columns(&self) -> impl Iterator<Item = String> {
        let first = FIRST.iter().map(|name| (*name).to_owned());
        let claims = self.claims.iter();
        let claims = claims.flat_map(|id| [format!("verdict:{id}"), format!("estimate:{id}")]);
        first.chain(self.settings.iter().cloned()).chain(claims)
    }
}

impl Multiverse {
    /// Writes one row per draw, the values that the manifest chose first.
    pub fn to_csv(&self) -> String {
        let header = Header { settings: self.settings.clone(), claims: self.claims.clone() };
        let mut table = Table::new(header.columns());
        for draw in self.runs() {
            let number = match draw.number {
                None => CHOSEN.into(),
                Some(number) => Value::from(i64::try_from(number).ok()),
            };
            let seed = Value::from(i64::try_from(self.seed).ok());
            let mut row = vec![number, seed, i64::from(self.trials).into()];
            let verdicts: &[Verdict] = match &draw.found {
                Found::Refused(reason) => {
                    row.extend([reason.as_str().into(), Value::Missing]);
                    &[]
                }
                Found::Judged { records, verdicts } => {
                    row.extend([Value::Missing, records.hex().into()]);
                    verdicts
                }
            };
            row.extend(draw.values.iter().map(|value| value.as_str().into()));
            for i in 0..self.claims.len() {
                let verdict = verdicts.get(i);
                row.push(verdict.map(|verdict| verdict.judgement.to_string()).into());
                row.push(verdict.and_then(|verdict| verdict.estimate).into());
            }
            table.push(row);
        }
        table.to_csv()
    }

    /// Reads what [`Self::to_csv`] writes.
    ///
    /// # Errors
    /// Where the text is no CSV, lacks a column or a draw, or a field holds what is never written there.
    pub fn from_csv(text: &str) -> Result<Self, MultiverseError> {
        let table = Table::from_csv(text).map_err(|e| MultiverseError(e.to_string()))?;
        let Some(header) = Header::of(&table.columns) else {
            // Nothing is quoted of a file of another kind: it may have been named by a slip.
            let is_ours = table.columns.iter().any(|column| FIRST.contains(&column.as_str()));
            let found = if is_ours { table.columns.join(", ") } else { "none of them".to_owned() };
            return Err(MultiverseError(format!(
                "line 1: expected the columns {}, then one for every setting, then verdict:ID and estimate:ID for every \
                 claim, found {found}; `reenact vary --joint` writes them",
                FIRST.join(", ")
            )));
        };
        let cells = [table.rows.len(), header.settings.len().max(1), header.claims.len().max(1)];
        if cells
            .iter()
            .try_fold(1_usize, |all, n| all.checked_mul(*n))
            .is_none_or(|n| n > MOST_CELLS)
        {
            let [draws, settings, claims] = cells;
            return Err(MultiverseError(format!(
                "expected draws, settings and claims of which there are {MOST_CELLS} at most when multiplied, found {draws} by \
                 {settings} by {claims}"
            )));
        }
        let mut rows = table.rows.iter().enumerate().map(|(i, fields)| (i + 2, fields));
        let Some((line, fields)) = rows.next() else {
            return Err(MultiverseError(format!(
                "line 2: expected draw `{CHOSEN}`, found nothing"
            )));
        };
        let first = Line { header: &header, number: line, fields };
        first.is_draw(CHOSEN)?;
        let seed = first.text(1).parse().map_err(|_| first.fault(1, "a seed"))?;
        let trials = first.text(2).parse().map_err(|_| first.fault(2, "a number of trials"))?;
        let chosen = first.draw(None)?;
        if let Found::Refused(_) = chosen.found {
            return Err(first.fault(3, "nothing at the values chosen"));
        }
        let mut draws = Vec::new();
        for (line, fields) in rows {
            let row = Line { header: &header, number: line, fields };
            // A draw that is left out would be one that nobody counts.
            row.is_draw(&draws.len().to_string())?;
            for (column, name) in [(1, "seed"), (2, "trials")] {
                if row.fields[column] != first.fields[column] {
                    let expected = format!("{} as everywhere, the {name}", first.text(column));
                    return Err(row.fault(column, &expected));
                }
            }
            draws.push(row.draw(Some(draws.len()))?);
        }
        let Header { settings, claims } = header;
        Ok(Self { seed, trials, settings, claims, chosen, draws })
    }
}

/// One line of the table.
struct Line<'a> {
    header: &'a Header,
    number: usize,
    fields: &'a [Value],
}

impl Line<'_> {
    fn text(&self, column: usize) -> String {
        self.fields[column].to_string()
    }

    fn fault(&self, column: usize, expected: &str) -> MultiverseError {
        let name = self.header.columns().nth(column).unwrap_or_default();
        let (line, found) = (self.number, self.text(column));
        MultiverseError(format!("line {line}: expected {expected} as {name}, found `{found}`"))
    }

    fn is_draw(&self, number: &str) -> Result<(), MultiverseError> {
        if self.text(0) == number { Ok(()) } else { Err(self.fault(0, number)) }
    }

    fn draw(&self, number: Option<usize>) -> Result<Draw, MultiverseError> {
        let settings = self.header.settings.len();
        let values = (FIRST.len()..FIRST.len() + settings).map(|column| self.text(column));
        let of_claims = FIRST.len() + settings;
        let found = if self.fields[3] == Value::Missing {
            let records = Sha256Digest::from_hex(&self.text(4));
            let records = records.ok_or_else(|| self.fault(4, "64 hex digits"))?;
            let verdict = |i: usize| {
                let (judged, estimated) = (of_claims + 2 * i, of_claims + 2 * i + 1);
                let known = Judgement::ALL.into_iter().find(|j| j.to_string() == self.text(judged));
                let judgement = known.ok_or_else(|| self.fault(judged, "a verdict"))?;
                let estimate = match &self.fields[estimated] {
                    Value::Missing => None,
                    value => {
                        let number = value.as_f64();
                        Some(number.ok_or_else(|| self.fault(estimated, "a number or nothing"))?)
                    }
                };
                Ok(Verdict { judgement, estimate })
            };
            let verdicts: Result<Vec<Verdict>, _> =
                (0..self.header.claims.len()).map(verdict).collect();
            Found::Judged { records, verdicts: verdicts? }
        } else {
            let said = [4].into_iter().chain(of_claims..self.fields.len());
            if let Some(column) = said.into_iter().find(|i| self.fields[*i] != Value::Missing) {
                return Err(self.fault(column, "nothing for a draw that is refused"));
            }
            Found::Refused(self.text(3))
        };
        Ok(Draw { number, values: values.collect(), found })
    }
}

#[cfg(test)]
pub(in crate::claims) mod tests {
    use super::*;

    /// Returns two choices, two claims and three draws, of which the last is refused.
    pub(in crate::claims) fn sample() -> Multiverse {
        Multiverse::from_csv(&text()).unwrap()
    }

    fn text() -> String {
        let digest = |first: &str| format!("{first}{}", "0".repeat(63));
        let judged = |draw: &str, first: &str, rest: &str| {
            format!("{draw},7,15,,{},{rest}\n", digest(first))
        };
        [
            "draw,seed,trials,refused,records,parameters.pilot.stop-m,parameters.pilot.heading,verdict:D1,estimate:D1,\
             verdict:D2,estimate:D2\n"
                .to_owned(),
            judged("chosen", "a", "0.05,compass,supported,0.5,inconclusive,"),
            judged("0", "b", "0.09,compass,supported,0.75,inconclusive,-0.25"),
            judged("1", "c", "0.07,walls,contradicted,-1,cannot-be-tested,"),
            "2,7,15,it is too near,,0.06,walls,,,,\n".to_owned(),
        ]
        .concat()
    }

    #[test]
    fn draws_survive_a_round_trip() {
        let table = sample();
        assert_eq!(table.to_csv(), text());
        assert_eq!((table.seed, table.trials, table.draws.len()), (7, 15, 3));
        assert_eq!(table.settings, ["parameters.pilot.stop-m", "parameters.pilot.heading"]);
        assert_eq!(table.claims, ["D1", "D2"]);
        assert_eq!(table.judged().count(), 2);
        let refused: Vec<_> = table.refused().map(|(draw, why)| (draw.number, why)).collect();
        assert_eq!(refused, [(Some(2), "it is too near")]);
    }

    #[test]
    fn other_tables_are_refused_in_words() {
        let told = |text: &str| Multiverse::from_csv(text).unwrap_err().to_string();
        let header = |found: &str| {
            format!(
                "line 1: expected the columns draw, seed, trials, refused, records, then one for every setting, then \
                 verdict:ID and estimate:ID for every claim, found {found}; `reenact vary --joint` writes them"
            )
        };
        assert_eq!(told("root:x:0:0\n"), header("none of them"));
        assert_eq!(told("draw,value\n"), header("draw, value"));
        let unpaired = "draw,seed,trials,refused,records,a,verdict:D1\n";
        assert_eq!(told(unpaired), header(unpaired.trim_end().replace(',', ", ").as_str()));
        let text = text();
        let head = text.lines().next().unwrap();
        assert_eq!(told(head), "line 2: expected draw `chosen`, found nothing");
        let changed = |from: &str, to: &str| {
            assert!(text.contains(from), "{from}");
            told(&text.replacen(from, to, 1))
        };
        assert_eq!(changed("\n1,7", "\n3,7"), "line 4: expected 1 as draw, found `3`");
        assert_eq!(
            changed("\n1,7", "\n1,8"),
            "line 4: expected 7 as everywhere, the seed as seed, found `8`"
        );
        assert_eq!(
            changed("\nchosen,7,15", "\nchosen,7,many"),
            "line 2: expected a number of trials as trials, found `many`"
        );
        assert_eq!(
            changed("walls,contradicted", "walls,wrong"),
            "line 4: expected a verdict as verdict:D1, found `wrong`"
        );
        assert_eq!(
            changed("supported,0.75", "supported,much"),
            "line 3: expected a number or nothing as estimate:D1, found `much`"
        );
        assert_eq!(
            changed("walls,,,,", "walls,supported,,,"),
            "line 5: expected nothing for a draw that is refused as verdict:D1, found `supported`"
        );
        assert_eq!(
            changed("chosen,7,15,,", "chosen,7,15,no,"),
            "line 2: expected nothing for a draw that is refused as records, found \
             `a000000000000000000000000000000000000000000000000000000000000000`"
        );
        let settings: Vec<String> = (0..400).map(|i| format!("p{i}")).collect();
        let settings = settings.join(",");
        let wide = format!(
            "draw,seed,trials,refused,records,{settings},verdict:0,estimate:0,verdict:1,estimate:1\n"
        );
        let row = format!("{}\n", ",".repeat(5 + 400 + 4 - 1));
        let wide = wide + &row.repeat(MOST_CELLS / 800 + 1);
        assert_eq!(
            told(&wide),
            "expected draws, settings and claims of which there are 4000000 at most when multiplied, found 5001 by 400 by 2"
        );
        let cut = told(&text.replace(&format!("c{}", "0".repeat(63)), "c0"));
        assert_eq!(cut, "line 4: expected 64 hex digits as records, found `c0`");
    }
}
