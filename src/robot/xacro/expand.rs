//! Walks through a file and does what its elements of xacro's say.

use super::macros::{self, Kind, Macro};
use super::scope::{Block, Property, Scopes};
use super::substitute::{Refusal, how_to_give, literal};
use super::tree::{self, Element, Node, Origin};
use super::value::Value;
use crate::document::{Diagnostic, Source, suggestion};
use crate::robot::files::{FilePath, Files, Places};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// How to expand a file elsewhere.
pub(super) const HELP: &str = "expand the file beforehand: `xacro robot.urdf.xacro > robot.urdf` (`pip install xacro` does without ROS)";

/// How deep elements, macros and properties may nest, all together.
const MAX_DEPTH: usize = 160;
/// How deep files may include one another.
const MAX_FILES: usize = 32;
/// How many elements an expansion may take.
const MAX_ELEMENTS: usize = 1_000_000;

/// A fault that ends the expansion.
pub(super) type Stop = Box<Diagnostic>;

/// What is known while files are expanded.
pub(super) struct Expander<'r> {
    pub(super) places: &'r Places<'r>,
    files: &'r mut dyn Files,
    /// The arguments that the manifest gives.
    pub(super) given: &'r BTreeMap<String, String>,
    /// Those, and the defaults of the others.
    pub(super) arguments: BTreeMap<String, String>,
    pub(super) scopes: Scopes,
    macros: BTreeMap<String, Macro>,
    /// The files that are open, the innermost last.
    open: Vec<FilePath>,
    pub(super) depth: usize,
    elements: usize,
    pub(super) work: usize,
    /// How many values would have come from the environment.
    pub(super) environment: usize,
    pub(super) warnings: Vec<Diagnostic>,
    /// The packages that were missed, each warned of once.
    missed: BTreeSet<String>,
}

impl<'r> Expander<'r> {
    pub(super) fn new(
        places: &'r Places<'r>,
        given: &'r BTreeMap<String, String>,
        files: &'r mut dyn Files,
    ) -> Self {
        Self {
            places,
            files,
            given,
            arguments: given.clone(),
            scopes: Scopes::new(),
            macros: BTreeMap::new(),
            open: Vec::new(),
            depth: 0,
            elements: 0,
            work: 0,
            environment: 0,
            warnings: Vec::new(),
            missed: BTreeSet::new(),
        }
    }

    /// Returns the root of `source` without its children, and those expanded.
    pub(super) fn file(
        &mut self,
        source: &Source,
        path: FilePath,
    ) -> Result<(Rc<Element>, Vec<Node>), Vec<Diagnostic>> {
        let root = tree::read(source)?;
        self.open.push(path);
        let mut nodes = Vec::new();
        let done = self.children(&root, &mut nodes);
        self.open.pop();
        done.map_err(|stop| vec![*stop])?;
        Ok((root, nodes))
    }

    /// Goes one step deeper.
    pub(super) fn deeper(&mut self) -> Result<(), Refusal> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let why =
                format!("it nests deeper than {MAX_DEPTH} levels, as a macro that calls itself");
            return Err(why.into());
        }
        Ok(())
    }

    /// Returns `text`, which stands at `origin`, with its expressions worked out.
    fn valued(&mut self, text: &str, origin: &Origin) -> Result<Value, Stop> {
        self.value(text, self.scopes.len()).map_err(|refusal| {
            let message = format!("cannot expand `{}`", crate::document::quoted(text.trim()));
            Box::new(origin.fault(message).label(refusal.why).help(refusal.help))
        })
    }

    pub(super) fn written(&mut self, text: &str, origin: &Origin) -> Result<String, Stop> {
        self.valued(text, origin).map(|value| value.to_string())
    }

    fn children(&mut self, parent: &Element, out: &mut Vec<Node>) -> Result<(), Stop> {
        self.nodes(&parent.children, &parent.origin, out)
    }

    fn nodes(&mut self, nodes: &[Node], at: &Origin, out: &mut Vec<Node>) -> Result<(), Stop> {
        for node in nodes {
            match node {
                Node::Element(element) => self.element(element, out)?,
                Node::Text(text) if text.contains('$') => {
                    out.push(Node::Text(self.written(text, at)?.into()));
                }
                Node::Text(text) => out.push(Node::Text(Rc::clone(text))),
            }
        }
        Ok(())
    }

    fn element(&mut self, element: &Rc<Element>, out: &mut Vec<Node>) -> Result<(), Stop> {
        self.elements += 1;
        if self.elements > MAX_ELEMENTS {
            let message = format!("the description expands to more than {MAX_ELEMENTS} elements");
            return Err(Box::new(element.origin.fault(message).help(HELP)));
        }
        self.deeper().map_err(|refusal| {
            let message = format!("cannot expand <{}>", element.name);
            Box::new(element.origin.fault(message).label(refusal.why).help(refusal.help))
        })?;
        if element.is_xacro {
            self.directive(element, out)?;
        } else {
            let mut attributes = Vec::new();
            for (name, value) in &element.attributes {
                attributes.push((name.clone(), self.written(value, &element.origin)?));
            }
            let mut children = Vec::new();
            self.children(element, &mut children)?;
            out.push(Node::Element(Rc::new(Element {
                name: element.name.clone(),
                is_xacro: false,
                attributes,
                children,
                origin: element.origin.clone(),
            })));
        }
        self.depth -= 1;
        Ok(())
    }

    fn directive(&mut self, element: &Rc<Element>, out: &mut Vec<Node>) -> Result<(), Stop> {
        match element.name.as_str() {
            "property" => self.define_property(element),
            "arg" => {
                let name = self.required(element, "name")?;
                if !self.arguments.contains_key(&name)
                    && let Some(default) = element.attribute("default")
                {
                    let default = self.written(default, &element.origin)?;
                    self.arguments.insert(name, default);
                }
                Ok(())
            }
            "include" => self.include(element, out),
            "macro" => {
                let name = self.required(element, "name")?;
                let name = name.strip_prefix("xacro:").unwrap_or(&name).to_owned();
                let parameters = macros::parameters(element.attribute("params").unwrap_or(""));
                self.macros.insert(name, Macro { parameters, body: Rc::clone(element) });
                Ok(())
            }
            "if" | "unless" => {
                let Some(written) = element.attribute("value") else {
                    return Err(lacks(element, "value"));
                };
                let value = self.valued(written, &element.origin)?;
                let Some(holds) = value.condition() else {
                    let message = format!("`{value}` is neither true nor false");
                    let label = "expected a number, `true` or `false`";
                    return Err(Box::new(element.origin.fault(message).label(label).help(HELP)));
                };
                if holds == (element.name == "if") {
                    self.children(element, out)?;
                }
                Ok(())
            }
            "insert_block" => self.insert(element, out),
            "call" => {
                let name = self.required(element, "macro")?;
                self.call(&name, element, out)
            }
            name @ ("element" | "attribute") => {
                let message = format!("<xacro:{name}> cannot be expanded here");
                Err(Box::new(element.origin.fault(message).help(HELP)))
            }
            name => self.call(name, element, out),
        }
    }

    fn required(&mut self, element: &Element, name: &str) -> Result<String, Stop> {
        match element.attribute(name) {
            Some(value) => self.written(value, &element.origin),
            None => Err(lacks(element, name)),
        }
    }

    fn define_property(&mut self, element: &Rc<Element>) -> Result<(), Stop> {
        let name = self.required(element, "name")?;
        let here = self.scopes.len();
        let at = match element.attribute("scope") {
            Some("global") => 0,
            Some("parent") => here.saturating_sub(2),
            _ => here - 1,
        };
        let written = match (element.attribute("value"), element.attribute("default")) {
            (Some(value), _) => value,
            (None, Some(_)) if self.scopes.property(&name, here).is_some() => return Ok(()),
            (None, Some(default)) => default,
            (None, None) => {
                let nodes = element.children.clone().into();
                self.scopes.set_block(at, &name, Block { nodes, is_expanded: false });
                return Ok(());
            }
        };
        let property = if at == here - 1 {
            match Value::of_literal(written) {
                Value::Text(text) if text.contains('$') => Property::Written(text),
                literal => Property::Value(literal),
            }
        } else {
            Property::Value(literal(self.valued(written, &element.origin)?))
        };
        self.scopes.set(at, &name, property);
        Ok(())
    }

    fn insert(&mut self, element: &Rc<Element>, out: &mut Vec<Node>) -> Result<(), Stop> {
        let name = self.required(element, "name")?;
        let Some(block) = self.scopes.block(&name) else {
            let message = format!("there is no block `{name}`");
            return Err(Box::new(element.origin.fault(message).help(HELP)));
        };
        if block.is_expanded {
            self.elements += block.nodes.len();
            self.work += 100 * block.nodes.len();
            out.extend(block.nodes.iter().cloned());
            return Ok(());
        }
        self.nodes(&block.nodes, &element.origin, out)
    }

    fn include(&mut self, element: &Rc<Element>, out: &mut Vec<Node>) -> Result<(), Stop> {
        let Some(written) = element.attribute("filename") else {
            return Err(lacks(element, "filename"));
        };
        let fault = |message: String| element.origin.fault(message);
        if let Some(namespace) = element.attribute("ns") {
            let message = format!("a file included as `{namespace}` cannot be expanded here");
            return Err(Box::new(fault(message).help(HELP)));
        }
        let uri = self.written(written, &element.origin)?;
        let beside = self.open.last().unwrap_or(&self.places.own);
        let file = match self.places.find(&uri, beside, self.files) {
            Ok(file) => file,
            Err(why) => {
                // A package that is missed may only hold what this robot does not carry: the macros tell.
                if let Some(name) = why.package() {
                    self.miss(element, &uri, &why.to_string(), how_to_give(name));
                    return Ok(());
                }
                let message = format!("cannot include `{uri}`");
                return Err(Box::new(fault(message).label(why.to_string()).help(HELP)));
            }
        };
        if self.open.contains(&file) {
            let message = format!("`{uri}` includes itself");
            return Err(Box::new(fault(message).label("it is open already")));
        }
        if self.open.len() >= MAX_FILES {
            let message = format!("files include one another more than {MAX_FILES} deep");
            return Err(Box::new(fault(message).help(HELP)));
        }
        let source = match self.files.text(&file) {
            Ok(source) => source,
            Err(_) if element.attribute("optional") == Some("true") => return Ok(()),
            Err(why) => {
                self.miss(element, &uri, &why.to_string(), HELP.to_owned());
                return Ok(());
            }
        };
        self.work += source.text.len();
        let (_, nodes) = self.file(&source, file).map_err(|faults| {
            let first = faults.into_iter().next();
            Box::new(first.unwrap_or_else(|| fault(format!("cannot include `{uri}`"))))
        })?;
        out.extend(nodes);
        Ok(())
    }

    /// Warns of a file that is left out.
    fn miss(&mut self, at: &Element, uri: &str, why: &str, help: String) {
        if self.missed.insert(format!("{uri}: {why}")) {
            let uri = crate::document::quoted(uri);
            let fault = at.origin.fault(format!("`{uri}` is not included")).label(why);
            self.warnings.push(fault.help(help).warning());
        }
    }

    fn call(&mut self, name: &str, at: &Rc<Element>, out: &mut Vec<Node>) -> Result<(), Stop> {
        let Some(called) = self.macros.get(name).cloned() else {
            let known = self.macros.keys().map(String::as_str);
            let fault = at.origin.fault(format!("unknown macro `{name}`"));
            // The file that is missed and named as the macro is likelier than a macro of a similar name.
            let missed = self.missed.iter().find(|missed| missed.contains(name));
            let help = match (missed, suggestion(name, known), self.missed.first()) {
                (None, Some(near), _) => format!("did you mean `{near}`?"),
                (Some(missed), _, _) | (None, None, Some(missed)) => {
                    format!("is it in a file that is not included ({missed})?")
                }
                (None, None, None) => HELP.to_owned(),
            };
            return Err(Box::new(fault.help(help)));
        };
        let fault = |message: String| Box::new(at.origin.fault(message).help(HELP));
        let here = self.scopes.len();
        // 1. What the call hands over, as its caller sees it.
        let mut handed: Vec<(String, Value)> = Vec::new();
        for (attribute, written) in &at.attributes {
            let is_own = |p: &macros::Parameter| p.name == *attribute;
            if at.name == "call" && attribute == "macro" {
                continue;
            }
            if !called.parameters.iter().any(is_own) {
                let message = format!("the macro `{name}` has no parameter `{attribute}`");
                return Err(fault(message));
            }
            handed.push((attribute.clone(), literal(self.valued(written, &at.origin)?)));
        }
        let mut inner = Vec::new();
        self.children(at, &mut inner)?;
        let mut blocks = inner.into_iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            Node::Text(_) => None,
        });
        // 2. Its parameters, in their order.
        let (mut properties, mut elements) = (Vec::new(), Vec::new());
        for parameter in called.parameters.iter() {
            let missing =
                || fault(format!("the macro `{name}` is not told its `{}`", parameter.name));
            let nodes: Rc<[Node]> = match &parameter.kind {
                Kind::Attribute(default) => {
                    let own = handed.iter().find(|(name, _)| *name == parameter.name);
                    let value = match (own, default) {
                        (Some((_, value)), _) => value.clone(),
                        (None, Some(default)) => {
                            let forwarded = if default.forwards {
                                self.forwarded(&parameter.name, &at.origin)?
                            } else {
                                None
                            };
                            match (forwarded, &default.text) {
                                (Some(value), _) => value,
                                (None, Some(text)) => literal(self.valued(text, &at.origin)?),
                                (None, None) => return Err(missing()),
                            }
                        }
                        (None, None) => return Err(missing()),
                    };
                    properties.push((&parameter.name, value));
                    continue;
                }
                Kind::Block => [Node::Element(blocks.next().ok_or_else(missing)?)].into(),
                Kind::Inner => blocks.next().ok_or_else(missing)?.children.clone().into(),
            };
            elements.push((&parameter.name, Block { nodes, is_expanded: true }));
        }
        // 3. What the macro holds.
        self.scopes.open();
        for (name, value) in properties {
            self.scopes.set(here, name, Property::Value(value));
        }
        for (name, block) in elements {
            self.scopes.set_block(here, name, block);
        }
        let done = self.children(&called.body, out);
        self.scopes.close();
        done.map_err(|mut stop| {
            if !stop.label.contains(" called at ") {
                let place = at.origin.fault("").location().unwrap_or_default();
                let comma = if stop.label.is_empty() { "" } else { "; " };
                stop.label += &format!("{comma}in the macro `{name}`, called at {place}");
            }
            stop
        })
    }

    fn forwarded(&mut self, name: &str, origin: &Origin) -> Result<Option<Value>, Stop> {
        self.property(name, self.scopes.len())
            .map_err(|refusal| Box::new(origin.fault(refusal.why).help(refusal.help)))
    }
}

fn lacks(element: &Element, attribute: &str) -> Stop {
    let message = format!("<xacro:{}> without a {attribute}", element.name);
    Box::new(element.origin.fault(message).label(format!("expected an attribute `{attribute}`")))
}
