//! A bundle that was opened and checked, for `reenact.Bundle`.

use crate::interruptible::interruptible;
use crate::replayed::{Played, replayed};
use crate::{refused, refused_with};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use reenact::bundle::{Bundle, Forgetful, assemble, in_payload};
use reenact::claims::{ClaimVerdict, tidy};
use reenact::cli::{Exit, Opened, open};
use reenact::plan::{Plan, Selection};
use reenact::report;
use reenact::studies;
use reenact::table::Table;
use reenact::verify::{Level, plan_of};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// What was refused while the interpreter did something else: how the command would end, and what it would say.
type Refusal = (Exit, String);

/// What is kept of a bundle.
struct Kept {
    opened: Opened,
    /// Made when it is first needed.
    plan: OnceLock<Result<(Plan, Selection), String>>,
}

impl Kept {
    fn bundle(&self) -> &Bundle {
        &self.opened.bundle
    }

    /// Returns the plan of the bundle's study.
    fn plan(&self) -> Result<&(Plan, Selection), Refusal> {
        let plan = self.plan.get_or_init(|| plan_of(self.bundle()).map_err(|e| e.to_string()));
        plan.as_ref().map_err(|problem| (Exit::NotUnderstood, problem.clone()))
    }

    fn finding(&self) -> Result<String, Refusal> {
        let (plan, selection) = self.plan()?;
        let content = report::content_of(self.bundle(), plan, selection);
        content.map(|content| report::finding(&content)).map_err(|e| (Exit::No, e.to_string()))
    }

    fn title(&self) -> Result<String, Refusal> {
        Ok(self.plan()?.0.experiment.title.clone())
    }

    /// Returns the curves of all trials as CSV; none where the study records none.
    fn series(&self) -> Result<Option<String>, Refusal> {
        let (plan, _) = self.plan()?;
        if !plan.experiment.kind.has_series() {
            return Ok(None);
        }
        let scratch = Forgetful::default();
        let gathered = self.bundle().gathered(plan, &scratch).map_err(|faults| {
            let faults: Vec<String> = faults.iter().map(ToString::to_string).collect();
            (Exit::No, faults.join("; "))
        })?;
        let findings = assemble::findings(plan, &gathered.ledger);
        let mut table: Table = findings.series();
        for row in findings.series_rows() {
            table.push(row);
        }
        Ok(Some(table.to_csv()))
    }

    /// Returns `results/NAME`, and where no claim was judged what `blank` has in its place: the columns alone.
    fn verdicts(&self, name: &str, blank: fn(&[ClaimVerdict]) -> Table) -> String {
        let sealed = self.bundle().result(name).map(String::from_utf8_lossy);
        sealed.map_or_else(|| blank(&[]).to_csv(), std::borrow::Cow::into_owned)
    }

    fn trials(&self) -> Result<Vec<String>, Refusal> {
        let (plan, _) = self.plan()?;
        let named = |spec: &studies::TrialSpec| format!("{}/{}", spec.condition.slug(), spec.trial);
        Ok(plan.trials.iter().map(named).collect())
    }

    fn replay(&self, wanted: &str, scans: bool) -> Result<Played, Refusal> {
        let (plan, _) = self.plan()?;
        let spec = plan.find(wanted).map_err(|e| (Exit::NotUnderstood, e.to_string()))?;
        let (record, recording) =
            if scans { studies::reenact_sensing(spec) } else { studies::reenact(spec) };
        let archived =
            self.bundle().record(&spec.key).map_err(|fault| (Exit::No, fault.to_string()))?;
        let same = archived.is_some_and(|archived| archived.to_line() == record.to_line());
        let name = format!("{}/{}", spec.condition.slug(), spec.trial);
        Ok(Played { name, key: spec.key.hex(), same, recording })
    }
}

/// A bundle as the commands open one.
#[pyclass(frozen, module = "reenact._reenact")]
pub(crate) struct Archive(Arc<Kept>);

impl Archive {
    /// Does `work` on the bundle, and heeds Ctrl-C meanwhile.
    fn asked<T: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Kept) -> Result<T, Refusal> + Send + 'static,
    ) -> PyResult<T> {
        let kept = Arc::clone(&self.0);
        let answer = interruptible(py, move || work(&kept))?;
        answer.map_err(|(exit, message)| refused_with(exit, message))
    }
}

#[pymethods]
impl Archive {
    /// Opens and checks the bundle at `path`.
    #[new]
    fn new(py: Python<'_>, path: PathBuf, level: u8, unchecked: bool) -> PyResult<Self> {
        let level = Level::from_number(level).ok_or_else(|| {
            let problem = format!("a bundle is opened at level 0 to 3, found {level}");
            refused_with(Exit::NotUnderstood, problem)
        })?;
        let opened = interruptible(py, move || open(&path, level, unchecked))?;
        let opened = opened.map_err(refused)?;
        Ok(Self(Arc::new(Kept { opened, plan: OnceLock::new() })))
    }

    #[getter]
    fn name(&self) -> &str {
        self.0.bundle().name()
    }

    #[getter]
    fn engine(&self) -> &str {
        self.0.bundle().engine()
    }

    #[getter]
    fn partial(&self) -> bool {
        self.0.bundle().is_partial()
    }

    #[getter]
    fn checked(&self) -> &str {
        &self.0.opened.checked
    }

    #[getter]
    fn holds(&self) -> bool {
        self.0.opened.holds
    }

    #[getter]
    fn results_digest(&self) -> String {
        format!("sha256:{}", self.0.bundle().results_digest())
    }

    #[getter]
    fn study_digest(&self) -> String {
        format!("sha256:{}", self.0.bundle().study_digest())
    }

    #[getter]
    fn bundle_id(&self) -> Option<String> {
        self.0.bundle().bundle_id().map(|id| format!("sha256:{id}"))
    }

    /// Returns every file of the payload with its size in bytes, sorted by path.
    fn files(&self) -> Vec<(String, u64)> {
        let files = self.0.bundle().files();
        files
            .iter()
            .filter_map(|(path, file)| Some((in_payload(path)?.to_owned(), file.size())))
            .collect()
    }

    /// Returns the bytes of a file of the payload; `None` where there is no such file.
    fn read<'py>(&self, py: Python<'py>, path: String) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let bytes = self.asked(py, move |kept| {
            let mut files = kept.bundle().files().iter();
            let Some((_, file)) = files.find(|(at, _)| in_payload(at) == Some(&path)) else {
                return Ok(None);
            };
            let whole = file.whole(u64::MAX).map(std::borrow::Cow::into_owned);
            let unread = || (Exit::Failed, format!("cannot read `{path}` of the bundle"));
            whole.map(Some).ok_or_else(unread)
        })?;
        Ok(bytes.map(|bytes| PyBytes::new(py, &bytes)))
    }

    fn title(&self, py: Python<'_>) -> PyResult<String> {
        self.asked(py, Kept::title)
    }

    fn finding(&self, py: Python<'_>) -> PyResult<String> {
        self.asked(py, Kept::finding)
    }

    fn trials(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.asked(py, Kept::trials)
    }

    fn claims(&self) -> String {
        self.0.verdicts("claims.csv", tidy::claims)
    }

    fn comparisons(&self) -> String {
        self.0.verdicts("comparisons.csv", tidy::comparisons)
    }

    fn series(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.asked(py, Kept::series)
    }

    /// Re-enacts a trial; `scans` says whether every scan is kept as the sensor gave it.
    fn replay<'py>(
        &self,
        py: Python<'py>,
        trial: String,
        scans: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let played = self.asked(py, move |kept| kept.replay(&trial, scans))?;
        replayed(py, &played)
    }
}
