use super::evaluate::evaluate;
use super::expression;
use super::value::Value;
use super::*;
use crate::document::mutation::{edits, mutate};
use crate::robot::files::{Rooted, Unfound};
use proptest::prelude::*;

/// Files by their path.
struct InMemory(BTreeMap<&'static str, &'static str>);

impl Files for InMemory {
    fn text(&mut self, file: &FilePath) -> Result<Source, Unfound> {
        let text = self.0.get(file.path.as_str());
        let text = text.ok_or_else(|| Unfound("no such file".to_owned()))?;
        Ok(Source::new(file.path.as_str(), *text))
    }

    fn corners(&mut self, _: &FilePath) -> Result<Vec<[f64; 3]>, Unfound> {
        Ok(Vec::new())
    }
}

const OTHERS: [(&str, &str); 3] = [
    (
        "pkg/urdf/wheel.xacro",
        include_str!("../../../tests/manifests/inputs/robots/cart/urdf/wheel.xacro"),
    ),
    ("pkg/urdf/loop.xacro", "<robot><xacro:include filename='loop.xacro'/></robot>"),
    (
        "pkg/urdf/two.xacro",
        "<robot><xacro:macro name='two' params='*a *b'><b1><xacro:insert_block name='b'/></b1><xacro:insert_block name='a'/></xacro:macro></robot>",
    ),
];

/// Expands what stands in a `<robot>`.
fn expanded(body: &str) -> Result<String, Vec<Diagnostic>> {
    whole(&format!("<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>{body}</robot>"))
        .map(|text| {
            let inner = text.strip_prefix("<robot name=\"r\">").unwrap();
            inner.strip_suffix("</robot>").unwrap().to_owned()
        })
}

fn whole(text: &str) -> Result<String, Vec<Diagnostic>> {
    let source = Source::new("pkg/urdf/r.xacro", text);
    let own = FilePath { path: "pkg/urdf/r.xacro".to_owned(), rooted: Rooted::Robot };
    let packages = BTreeMap::new();
    let arguments = BTreeMap::from([("given".to_owned(), "7".to_owned())]);
    let places = Places { own, packages: &packages };
    let mut files = InMemory(BTreeMap::from(OTHERS));
    expand(&source, &[], &arguments, &places, &mut files).map(|e| e.source.text.to_string())
}

fn refused(body: &str) -> String {
    expanded(body).unwrap_err()[0].render(false)
}

fn worked_out(text: &str) -> String {
    let parsed = expression::parse(text).unwrap();
    evaluate(&parsed, &mut |name| {
        Ok(match name {
            "two" => Some(Value::Int(2)),
            "name" => Some(Value::Text("arm".into())),
            _ => None,
        })
    })
    .map_or_else(|why| why, |value| value.to_string())
}

/// The values are those that Python prints.
#[test]
fn expressions_are_those_of_python() {
    for (text, value) in [
        ("1 + 2 * 3", "7"),
        ("7 / 2", "3.5"),
        ("-7 // 2", "-4"),
        ("-7 % 3", "2"),
        ("7 % -3", "-2"),
        ("7.5 // 2", "3.0"),
        ("2 ** 3 ** 2", "512"),
        ("-2 ** 2", "-4"),
        ("2 ** -1", "0.5"),
        ("1e-3 + .5", "0.501"),
        ("0.1 + 0.2", "0.30000000000000004"),
        ("4.0", "4.0"),
        ("1 < two <= 2", "True"),
        ("not 1 or two", "2"),
        ("0 and 1 / 0", "0"),
        ("'a' if two == 2 else 'b'", "a"),
        ("'left' in ['left', 'right']", "True"),
        ("3 not in range(1, 3)", "True"),
        ("name + '_link'", "arm_link"),
        ("name == 'arm' and True", "True"),
        ("radians(180) == pi", "True"),
        ("degrees(math.pi / 2)", "90.0"),
        ("cos(0)", "1.0"),
        ("max(1, two, 1.5)", "2"),
        ("abs(-3)", "3"),
        ("sqrt(16)", "4.0"),
        ("round(2.5)", "2"),
        ("round(2.675, 2)", "2.67"),
        ("int(-2.7)", "-2"),
        ("'1 2 3'.split(' ')[1]", "2"),
        ("[1, 2, 3][-1]", "3"),
        ("'front_left'[-4:]", "left"),
        ("dict(a=1, b=2)['b']", "2"),
        ("{'a': {'b': 5}}['a'].b", "5"),
        ("len('abc') + len([1])", "4"),
        ("[1.5, 'x', True]", "[1.5, 'x', True]"),
        ("1 / 0", "it divides by zero"),
        ("nothing", "`nothing` is not defined"),
        ("open('x')", "the function `open` is not known"),
        ("'a' + 1", "`+` does not take text and a number"),
        ("10 ** 400", "its result is no finite number"),
    ] {
        assert_eq!(worked_out(text), value, "{text}");
    }
    for text in ["", "1 +", "(1", "a b", "1 = 2", "'a", "f(1", "[1", "a.", "not", "§"] {
        assert!(expression::parse(text).is_err(), "{text}");
    }
    let deep = format!("{}1{}", "(".repeat(1000), ")".repeat(1000));
    assert!(expression::parse(&deep).unwrap_err().contains("nests deeper"));
    assert!(expression::parse(&("1 ** ".repeat(1000) + "1")).is_err());
}

#[test]
fn properties_are_worked_out_when_they_are_used_and_shadowed_by_macros() {
    let body = "<xacro:property name='a' value='${b * 2}'/><xacro:property name='b' value='3'/>\
        <xacro:macro name='m' params='b c:=${b + 1} d:=^|9'><x a='${a}' b='${b}' c='${c}' d='${d}'/></xacro:macro>\
        <y a='${a}'/><xacro:m b='5'/><xacro:property name='d' value='1'/><xacro:m b='6' c='two words'/>";
    assert_eq!(
        expanded(body).unwrap(),
        "<y a=\"6\"></y><x a=\"6\" b=\"5\" c=\"4\" d=\"9\"></x><x a=\"6\" b=\"6\" c=\"two words\" d=\"1\"></x>"
    );
}

#[test]
fn blocks_conditions_arguments_and_includes_are_followed() {
    let body = "<xacro:arg name='n' default='1'/><xacro:arg name='given' default='1'/>\
        <xacro:include filename='two.xacro'/><xacro:property name='o'><origin z='$(arg n)'/></xacro:property>\
        <xacro:two><p q='${1}'/><xacro:insert_block name='o'/></xacro:two>\
        <xacro:if value='$(arg n)'><yes/></xacro:if><xacro:unless value='${2 > 1}'><no/></xacro:unless>\
        <g v='$(arg given) $(optenv HOME none at all)' f='$(find pkg)/a' e='$$(arg n)'>$(eval arg('n') + 1)</g>";
    assert_eq!(
        expanded(body).unwrap(),
        "<b1><origin z=\"1\"></origin></b1><p q=\"1\"></p><yes></yes>\
         <g v=\"7 none at all\" f=\"package://pkg/a\" e=\"$(arg n)\">2</g>"
    );
}

#[test]
fn a_property_that_goes_to_the_caller_or_to_the_file_stays_when_the_macro_ends() {
    let body = "<xacro:macro name='m' params=''>\
        <xacro:property name='p' value='1' scope='parent'/><xacro:property name='l' value='2'/></xacro:macro>\
        <xacro:m/><x p='${p}'/>";
    assert_eq!(expanded(body).unwrap(), "<x p=\"1\"></x>");
    assert!(refused(&(body.to_owned() + "<x l='${l}'/>")).contains("`l` is not defined"));
}

#[test]
fn what_cannot_be_expanded_says_where_and_what_to_do() {
    assert_eq!(
        whole("<robot xmlns:xacro='http://ros.org/wiki/xacro'>\n  <link name='${side}_wheel'/>\n</robot>")
            .unwrap_err()[0]
            .render(false),
        "\
error: cannot expand `${side}_wheel`
 --> pkg/urdf/r.xacro:2:3
  |
2 |   <link name='${side}_wheel'/>
  |   ^^^^^ `side` is not defined
  |
  = help: give it as `robot: {file, arguments: {side: VALUE}}` where whoever starts the robot does; else expand the file \
beforehand: `xacro robot.urdf.xacro > robot.urdf` (`pip install xacro` does without ROS)
"
    );
    for (body, said) in [
        ("<x a='${p}'/><xacro:property name='p' value='1'/>", "`p` is not defined"),
        ("<xacro:property name='p' value='${p}'/><x a='${p}'/>", "`p` is made of itself"),
        ("<xacro:include filename='loop.xacro'/>", "`loop.xacro` includes itself"),
        ("<xacro:m/>", "unknown macro `m`"),
        ("<xacro:macro name='wheel' params=''/><xacro:wheels/>", "did you mean `wheel`?"),
        ("<xacro:macro name='m' params='a'/><xacro:m/>", "the macro `m` is not told its `a`"),
        ("<xacro:macro name='m' params=''/><xacro:m b='1'/>", "the macro `m` has no parameter `b`"),
        ("<xacro:if value='maybe'/>", "`maybe` is neither true nor false"),
        ("<xacro:if/>", "<xacro:if> without a value"),
        ("<x a='$(env HOME)'/>", "the environment is not read"),
        ("<x a='$(arg leg)'/>", "the argument `leg` has no default"),
        ("<x a='$(command ls)'/>", "`$(command)` is not known"),
        ("<x a='${xacro.load_yaml(1)}'/>", "the function `xacro.load_yaml` is not known"),
        ("<xacro:element/>", "<xacro:element> cannot be expanded here"),
        ("<xacro:insert_block name='b'/>", "there is no block `b`"),
        ("<x a='${xacro.error(\"no wheels\")}'/>", "the description says: no wheels"),
        ("<xacro:include filename='/etc/passwd'/>", "a path from the root of some machine"),
        ("<xacro:include filename='../../../x'/>", "leads out of the folders"),
        ("<xacro:include filename='two.xacro' ns='n'/>", "a file included as `n`"),
        (
            "<xacro:macro name='m' params=''><xacro:m/></xacro:macro><xacro:m/>",
            "as a macro that calls itself",
        ),
    ] {
        let found = refused(body);
        assert!(found.contains(said), "{body}: {found}");
    }
}

/// A few lines may not cost hours.
#[test]
fn descriptions_that_multiply_are_stopped() {
    let mut bomb = "<xacro:macro name='m0' params=''><a/></xacro:macro>".to_owned();
    for i in 1..30 {
        let calls = format!("<xacro:m{}/>", i - 1).repeat(10);
        bomb += &format!("<xacro:macro name='m{i}' params=''>{calls}</xacro:macro>");
    }
    assert!(refused(&(bomb + "<xacro:m29/>")).contains("more than 1000000 elements"));
    let mut doubling = "<xacro:property name='p0' value='aaaaaaaaaaaaaaaa'/>".to_owned();
    for i in 1..40 {
        doubling += &format!("<xacro:property name='p{i}' value='${{p{0}}}${{p{0}}}'/>", i - 1);
    }
    assert!(refused(&(doubling + "<x a='${p39}'/>")).contains("longer than"));
    let deep = "<a>".repeat(60) + &"</a>".repeat(60);
    assert!(expanded(&deep).is_ok());
}

const CART: &str = include_str!("../../../tests/manifests/inputs/robots/cart/urdf/cart.urdf.xacro");

proptest! {
    #[test]
    fn damaged_macros_never_panic(edits in edits()) {
        let text = String::from_utf8_lossy(&mutate(CART.as_bytes(), &edits)).into_owned();
        match whole(&text.replace("$(find cart)", "$(find pkg)")) {
            Ok(text) => prop_assert!(roxmltree::Document::parse(&text).is_ok() || !text.is_empty()),
            Err(faults) => prop_assert!(!faults.is_empty()),
        }
    }

    #[test]
    fn whatever_stands_in_braces_never_panics(text in "[-+*/%().,:'\"a-c0-9 \\[\\]{}<>=!eif]{0,40}") {
        worked_out_or_not(&text);
    }
}

fn worked_out_or_not(text: &str) {
    if let Ok(parsed) = expression::parse(text) {
        drop(evaluate(&parsed, &mut |_| Ok(Some(Value::Int(1)))));
    }
}
