//! Answers as JUnit XML, for CI: after Jenkins' `junit-10.xsd`, which GitLab and most viewers follow.
//!
//! What ends a command with another code than 0 is a failure or an error here, and nothing else is: a claim that the
//! results contradict is a result.

use crate::verify::printable;

/// The class of all cases of `reenact run`.
pub(super) const RUN: &str = "reenact.run";

/// What came of a case.
#[derive(Debug)]
pub(super) enum Came {
    /// As it should be.
    Passed,
    /// The answer is no, for this reason.
    Failed(String),
    /// We failed, for this reason.
    Broken(String),
    /// Nobody can say, for this reason.
    Skipped(String),
}

/// A thing that was checked.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) name: String,
    pub(super) class: &'static str,
    pub(super) came: Came,
    /// What is to be read beside it; may be empty.
    pub(super) said: String,
}

/// What was checked of one manifest.
#[derive(Debug)]
pub(super) struct Suite {
    pub(super) name: String,
    pub(super) seconds: f64,
    pub(super) properties: Vec<(&'static str, String)>,
    pub(super) cases: Vec<Case>,
}

impl Suite {
    fn count(&self, wanted: fn(&Came) -> bool) -> usize {
        self.cases.iter().filter(|case| wanted(&case.came)).count()
    }

    fn failures(&self) -> usize {
        self.count(|came| matches!(came, Came::Failed(_)))
    }

    fn errors(&self) -> usize {
        self.count(|came| matches!(came, Came::Broken(_)))
    }
}

/// Writes what `command` found.
pub(super) fn document(command: &str, suites: &[Suite]) -> String {
    let sum = |of: fn(&Suite) -> usize| suites.iter().map(of).sum::<usize>();
    let seconds: f64 = suites.iter().map(|suite| suite.seconds).sum();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"reenact {command}\" tests=\"{}\" failures=\"{}\" \
         errors=\"{}\" time=\"{seconds:.3}\">\n",
        sum(|suite| suite.cases.len()),
        sum(Suite::failures),
        sum(Suite::errors),
    );
    for suite in suites {
        let skipped = suite.count(|came| matches!(came, Came::Skipped(_)));
        text.push_str(&format!(
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{skipped}\" time=\"{:.3}\">\n    \
             <properties>\n",
            printable(&suite.name),
            suite.cases.len(),
            suite.failures(),
            suite.errors(),
            suite.seconds,
        ));
        for (name, value) in &suite.properties {
            let value = printable(value);
            text.push_str(&format!("      <property name=\"{name}\" value=\"{value}\"/>\n"));
        }
        text.push_str("    </properties>\n");
        suite.cases.iter().for_each(|case| text.push_str(&line(case)));
        text.push_str("  </testsuite>\n");
    }
    text.push_str("</testsuites>");
    text
}

fn line(case: &Case) -> String {
    let told = |element: &str, why: &str| {
        let first = printable(why.lines().next().unwrap_or_default());
        format!(
            "<{element} message=\"{first}\" type=\"{}\">{}</{element}>",
            case.class,
            printable(why)
        )
    };
    let mut body = match &case.came {
        Came::Passed => String::new(),
        Came::Failed(why) => told("failure", why),
        Came::Broken(why) => told("error", why),
        Came::Skipped(why) => format!("<skipped message=\"{}\"/>", printable(why)),
    };
    if !case.said.is_empty() {
        body.push_str(&format!("<system-out>{}</system-out>", printable(&case.said)));
    }
    let (name, class) = (printable(&case.name), case.class);
    format!(
        "    <testcase name=\"{name}\" classname=\"{class}\" time=\"0.000\">{body}</testcase>\n"
    )
}
