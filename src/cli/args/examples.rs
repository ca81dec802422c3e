//! What `--help` shows last: the command as one types it. A test parses every line of these.

pub(super) const ALL: &str = "\
Examples:
  reenact run manifests/quickstart.yaml       simulate, and seal a bundle under artifacts/
  reenact verify artifacts/NAME-DIGEST.zip    is the bundle what it says?
  reenact report artifacts/NAME-DIGEST.zip    the bundle as one page
  reenact init first                          a study of your own";

pub(super) const RUN: &str = "\
Examples:
  reenact run manifests/quickstart.yaml
  reenact run manifests/deadline.yaml --only start=A --trials 5
  reenact run manifests/quickstart.yaml --set seed=7 --format json
  reenact run manifests/*.yaml --locked --probe";

pub(super) const MERGE: &str = "\
Examples:
  reenact merge shards/*.zip
  reenact merge one.zip two.zip -o whole.zip";

pub(super) const SUBMIT: &str = "\
Examples:
  reenact submit manifests/deadline.yaml --engine slurm --shards 20 --dry-run
  reenact submit manifests/deadline.yaml --engine slurm --shards 20 --time 1:00:00";

pub(super) const CHECK: &str = "\
Examples:
  reenact check manifests/quickstart.yaml
  reenact check manifests/*.yaml --format json";

pub(super) const PLAN: &str = "\
Examples:
  reenact plan manifests/quickstart.yaml
  reenact plan manifests/quickstart.yaml --explain none/0
  reenact plan manifests/deadline.yaml --power";

pub(super) const VERIFY: &str = "\
Examples:
  reenact verify study.zip
  reenact verify --level 4 --sample 20 study.zip
  reenact verify --level 5 --format json study.zip
  reenact verify --trust allowed_signers study.zip";

pub(super) const ATTEST: &str = "\
Examples:
  reenact attest review.json --signature review.json.pae.sig";

pub(super) const DIFF: &str = "\
Examples:
  reenact diff old.zip new.zip
  reenact diff manifests/quickstart.lock new.zip
  reenact diff old.zip new.zip --tolerance 1% --format html -o changes.html";

pub(super) const LOCK: &str = "\
Examples:
  reenact lock manifests/quickstart.yaml";

pub(super) const VARY: &str = "\
Examples:
  reenact vary manifests/deadline.yaml --trials 15
  reenact vary manifests/deadline.yaml --joint 24 --seed 7";

pub(super) const INFER: &str = "\
Examples:
  reenact infer manifests/deadline-infer.yaml";

pub(super) const REPORT: &str = "\
Examples:
  reenact report study.zip
  reenact report study.zip -o study.html";

pub(super) const EXPORT: &str = "\
Examples:
  reenact export study.zip --dir
  reenact export study.zip --rocrate --out deposit
  reenact export study.zip --latex
  reenact export study.zip --appendix
  reenact export study.zip --site site --page target/page/verify.html";

pub(super) const REPLAY: &str = "\
Examples:
  reenact replay study.zip none/0 --html trial.html
  reenact replay study.zip none/0 floor-plan/0 --html both.html
  reenact replay study.zip none/0 --mcap trial.mcap";

pub(super) const SHOW: &str = "\
Examples:
  reenact show worlds/basic.yaml
  reenact show robots/kobuki.urdf -o robot.svg
  reenact show --generate office-floor --seed 3";

pub(super) const SOLVE_CMDP: &str = "\
Examples:
  reenact solve-cmdp plan.json";

pub(super) const SCHEMA: &str = "\
Examples:
  reenact schema > manifest.schema.json
  reenact schema verify";

pub(super) const COMPLETIONS: &str = "\
Examples:
  reenact completions bash > ~/.local/share/bash-completion/completions/reenact
  reenact completions fish > ~/.config/fish/completions/reenact.fish";

pub(super) const MAN: &str = "\
Examples:
  reenact man ~/.local/share/man/man1";

pub(super) const IMPORT: &str = "\
Examples:
  reenact import hall.world -o hall.yaml
  reenact import map.yaml --unknown free";

pub(super) const INIT: &str = "\
Examples:
  reenact init first
  reenact init hall-study --robot robot.urdf --world hall.world";

pub(super) const CACHE: &str = "\
Examples:
  reenact cache size
  reenact cache verify --format json
  reenact cache prune --older-than 90
  reenact cache export -o trials.pack";

#[cfg(test)]
mod tests {
    use super::super::Arguments;
    use clap::CommandFactory as _;

    #[test]
    fn every_command_has_examples_and_every_example_can_be_typed() {
        let whole = Arguments::command();
        let named = whole.get_subcommands().map(|command| (command.get_name(), command));
        let all = std::iter::once(("reenact", &whole)).chain(named);
        let mut parsed = 0;
        for (name, command) in all {
            let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let lines: Vec<&str> = text.lines().skip(1).map(str::trim).collect();
            assert!(text.starts_with("Examples:\n") && !lines.is_empty(), "{name}: {text}");
            for line in lines {
                // What stands far behind a command says what it does; a shell takes `> FILE`.
                let typed = line.split("  ").next().unwrap_or_default();
                let typed = typed.split(" > ").next().unwrap_or_default();
                let words: Vec<&str> = typed.split(' ').collect();
                assert!(name == "reenact" || words[1] == name, "{name}: {line}");
                Arguments::read(words.iter().map(Into::into))
                    .unwrap_or_else(|e| panic!("{line}: {e}"));
                parsed += 1;
            }
        }
        assert!(parsed > 40, "{parsed}");
    }
}
