//! The cells of a table that is to be explained, whatever is printed in them.

/// A table of cells that columns of it tell apart.
pub trait Cells {
    /// Returns the columns that tell its cells apart.
    fn factors(&self) -> &[String];

    /// Returns how many cells there are.
    fn count(&self) -> usize;

    /// Returns the values of the factors of the cell `index`.
    fn levels_at(&self, index: usize) -> &[String];

    /// Returns whether the cell `index` is left out.
    fn is_left_out(&self, index: usize) -> bool;

    /// Returns the place of the factor `name` among the levels of a cell.
    fn factor(&self, name: &str) -> Option<usize> {
        self.factors().iter().position(|factor| factor == name)
    }

    /// Returns the levels of a factor, in order of appearance.
    fn levels(&self, factor: usize) -> Vec<&str> {
        let mut levels: Vec<&str> = Vec::new();
        for index in 0..self.count() {
            let level = self.levels_at(index)[factor].as_str();
            if !levels.contains(&level) {
                levels.push(level);
            }
        }
        levels
    }

    /// Returns for every cell the rank of its level of `factor`, in order of appearance among the cells that share its level of the
    /// first factor: deadlines that differ from start to start have ranks nevertheless.
    fn ranks(&self, factor: usize) -> Vec<usize> {
        let mut known: Vec<(&str, Vec<&str>)> = Vec::new();
        let mut ranks = Vec::with_capacity(self.count());
        let overall = self.levels(0);
        for index in 0..self.count() {
            let own = self.levels_at(index);
            let (group, level) = (own[0].as_str(), own[factor].as_str());
            if factor == 0 {
                ranks.push(overall.iter().position(|known| *known == level).unwrap_or(0));
                continue;
            }
            if !known.iter().any(|(name, _)| *name == group) {
                known.push((group, Vec::new()));
            }
            let here = known.iter_mut().find(|(name, _)| *name == group);
            let Some((_, levels)) = here else { continue };
            let rank = levels.iter().position(|known| *known == level).unwrap_or_else(|| {
                levels.push(level);
                levels.len() - 1
            });
            ranks.push(rank);
        }
        ranks
    }
}
