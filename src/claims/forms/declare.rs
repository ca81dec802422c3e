//! The terms that forms share, declared once: name, default, meaning.

/// Declares the struct of a form: its own fields, then those of the shared terms that it has, and `shared_terms`, which reads
/// them. A term that means something more particular in a form has a doc comment of its own there.
macro_rules! form {
    ($(#[$meta:meta])* pub struct $name:ident { $($own:tt)* } terms { $($terms:tt)* }) => {
        form!(@ {$(#[$meta])* $name} {$($own)*} {} $($terms)*);
    };
    (@ {$(#[$meta:meta])* $name:ident} {$($fields:tt)*} {$($term:ident)*}) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        $(#[$meta])*
        pub struct $name {
            $($fields)*
        }

        impl $name {
            fn shared_terms(&self) -> $crate::claims::terms::Terms {
                let minimum_runs = self.minimum_n;
                let mut terms = $crate::claims::terms::Terms {
                    minimum_runs,
                    ..$crate::claims::terms::Terms::default()
                };
                $(terms.$term = self.$term;)*
                terms
            }
        }
    };

    // What a term means where its form does not say more.
    (@ $head:tt $fields:tt $set:tt sides, $($rest:tt)*) => {
        form!(@ $head $fields $set /** Tails that count. */ sides, $($rest)*);
    };
    (@ $head:tt $fields:tt $set:tt alpha, $($rest:tt)*) => {
        form!(@ $head $fields $set /** Level of significance. */ alpha, $($rest)*);
    };
    (@ $head:tt $fields:tt $set:tt minimum_n, $($rest:tt)*) => {
        form!(@ $head $fields $set /** Runs per cell without which nothing is judged. */ minimum_n, $($rest)*);
    };
    (@ $head:tt $fields:tt $set:tt censored, $($rest:tt)*) => {
        form!(@ $head $fields $set /** What becomes of runs that did not reach the measure. */ censored, $($rest)*);
    };

    // How it is written, and what stands for one that is not.
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} $(#[$doc:meta])+ test, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            $(#[$doc])+
            pub test: Option<$crate::claims::terms::Test>,
        } {$($set)* test} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} $(#[$doc:meta])+ sides, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            $(#[$doc])+
            #[serde(default)]
            pub sides: $crate::claims::terms::Sides,
        } {$($set)* sides} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} $(#[$doc:meta])+ alpha, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            $(#[$doc])+
            #[serde(default = "crate::claims::terms::five_percent")]
            pub alpha: f64,
        } {$($set)* alpha} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} correction, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            /// Over the comparisons of this claim.
            #[serde(default)]
            pub correction: $crate::claims::terms::Correction,
        } {$($set)* correction} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} at_least, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            /// How many of the comparisons must hold; default all.
            pub at_least: Option<usize>,
        } {$($set)* at_least} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} $(#[$doc:meta])+ minimum_n, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            $(#[$doc])+
            #[serde(default = "crate::claims::terms::ten")]
            pub minimum_n: u64,
        } {$($set)* minimum_n} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} also_at_n, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            /// Effect and p of the first so many trials of each condition, to stand beside those of all: the paper's n.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub also_at_n: Option<u64>,
        } {$($set)* also_at_n} $($rest)*);
    };
    (@ $head:tt {$($fields:tt)*} {$($set:tt)*} $(#[$doc:meta])+ censored, $($rest:tt)*) => {
        form!(@ $head {
            $($fields)*
            $(#[$doc])+
            #[serde(default)]
            pub censored: $crate::claims::terms::Censored,
        } {$($set)* censored} $($rest)*);
    };
}
pub(super) use form;
