//! Reads the text of a file into a document. Here a text is refused if it is not XML, or not a file of trees. `build`
//! checks the meaning of nodes.

use std::cell::Cell;

use roxmltree::{Document as Xml, Node, ParsingOptions};

use crate::document::{Attribute, Document, Element, Form, Kept, Model, ModelPort, SourcePosition, TreeDefinition};
use crate::error::{Reason, TreeError, format_4_name};
use crate::findings::Findings;
use crate::leaf::Direction;
use crate::tree::DEEPEST;

/// Maximum length of a file, in bytes. It is a hundred times what a large mission needs.
pub const LONGEST_FILE: usize = 1 << 20;

/// Maximum number of elements in a file, including comments and texts between them. This is three times as many as a
/// tree may have nodes.
const MOST_XML_NODES: u32 = 1 << 15;

/// Maximum number of trees in a file. Each tree is checked with all subtrees that it uses.
const MOST_TREES: usize = 200;

/// Maximum number of models in a file. Every element is looked up among them.
const MOST_MODELS: usize = 500;

/// Maximum number of ports of a model. Each use of a leaf binds all its ports.
const MOST_PORTS: usize = 256;

/// Maximum number of attributes of an element. No node that people write has so many ports. Each attribute is
/// compared with all others, so more attributes would take long.
const MOST_ATTRIBUTES: usize = 64;

/// Reads the text of a file, which may have at most [`LONGEST_FILE`] bytes.
///
/// # Errors
/// The first fault, with its place.
pub fn read(text: &str) -> Result<Document, TreeError> {
    let mut findings = Findings::default();
    let document = read_with(text, &mut findings);
    findings.first()?;
    Ok(document.expect("a file without a fault is a document"))
}

/// Reads a file and collects all its faults. A document with faults can still be checked, so that all faults are
/// known at once. It can be neither run nor written. Returns `None` if the rest of the file cannot be read.
pub fn read_with(text: &str, findings: &mut Findings) -> Option<Document> {
    parsed(text, findings).map_err(|error| findings.fault(error)).ok()
}

fn parsed(text: &str, findings: &mut Findings) -> Result<Document, TreeError> {
    let start = SourcePosition { line: 1, column: 1 };
    if text.len() > LONGEST_FILE {
        return Err(TreeError::at(start, Reason::TooLong { length: text.len(), most: LONGEST_FILE }));
    }
    let lines = Lines::of(text);
    look_at_attributes(&lines)?;
    let options = ParsingOptions { nodes_limit: MOST_XML_NODES, ..ParsingOptions::default() };
    let xml = Xml::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        if error == roxmltree::Error::NodesLimitReached {
            let what = "elements, comments and texts in one file";
            return TreeError::at(start, Reason::TooMany { what, most: MOST_XML_NODES as usize });
        }
        // The place is already shown in front, so it is removed from the end of the message.
        let said = error.to_string();
        let said = said.strip_suffix(&format!(" at {at}")).unwrap_or(&said);
        TreeError::at(SourcePosition { line: at.row, column: at.col }, Reason::NotXml(said.to_owned()))
    })?;
    XmlReader { xml: &xml, lines, findings }.document()
}

/// Refuses files that would take long to parse. The parser compares each attribute with all others of its
/// element, and each namespace with all namespaces in scope.
fn look_at_attributes(lines: &Lines<'_>) -> Result<(), TreeError> {
    let text = lines.text;
    let refuse = |at: usize, reason: Reason| Err(TreeError::at(lines.place(at), reason));
    let behind = |from: usize, end: &str| text[from..].find(end).map(|found| from + found + end.len());
    let (mut at, mut is_root) = (0, true);
    while let Some(open) = text[at..].find('<').map(|found| at + found) {
        let passed = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((begin, end)) = passed.into_iter().find(|(begin, _)| text[open..].starts_with(begin)) {
            let Some(end) = behind(open + begin.len(), end) else { return Ok(()) };
            at = end;
            continue;
        }
        let mut attributes = 0;
        at = open + 1;
        while let Some(next) = text[at..].find(['"', '\'', '>']).map(|found| at + found) {
            // The root may declare prefixes, because the attribute that names the schema has a prefix.
            let is_refused = |word: &str| word.starts_with("xmlns") && !(is_root && word.starts_with("xmlns:"));
            if text[at..next].split_ascii_whitespace().any(is_refused) {
                return refuse(open, Reason::Namespace);
            }
            let quote = text.as_bytes()[next];
            at = next + 1;
            if quote == b'>' {
                break;
            }
            attributes += 1;
            if attributes > MOST_ATTRIBUTES {
                return refuse(open, Reason::TooMany { what: "attributes in one element", most: MOST_ATTRIBUTES });
            }
            let Some(end) = behind(at, if quote == b'"' { "\"" } else { "'" }) else { return Ok(()) };
            at = end;
        }
        is_root = false;
    }
    Ok(())
}

struct Lines<'x> {
    text: &'x str,
    /// Where each line begins, in bytes. Without this list, searching for each node would take quadratic time.
    starts: Vec<usize>,
    /// The byte offset that was looked up last, and its column. The next lookup is usually a little further on, so
    /// its column is counted from here. Without this, a file of one long line would be slow.
    last: Cell<(usize, usize)>,
}

impl<'x> Lines<'x> {
    fn of(text: &'x str) -> Lines<'x> {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Lines { text, starts, last: Cell::new((0, 1)) }
    }

    fn place(&self, at: usize) -> SourcePosition {
        let line = self.starts.partition_point(|start| *start <= at);
        let start = self.starts[line - 1];
        let (last, before) = self.last.get();
        let (from, counted) = if (start..=at).contains(&last) { (last, before) } else { (start, 1) };
        let column = counted + self.text[from..at].chars().count();
        self.last.set((at, column));
        let number = |number| u32::try_from(number).unwrap_or(u32::MAX);
        SourcePosition { line: number(line), column: number(column) }
    }
}

struct XmlReader<'x, 'f> {
    xml: &'x Xml<'x>,
    lines: Lines<'x>,
    findings: &'f mut Findings,
}

/// Faults are added to the findings. An `Err` is a fault after which the file cannot be read any further.
impl<'x> XmlReader<'x, '_> {
    fn of(&self, node: Node<'_, '_>) -> SourcePosition {
        self.lines.place(node.range().start)
    }

    fn refuse<T>(&self, node: Node<'_, '_>, reason: Reason) -> Result<T, TreeError> {
        Err(TreeError::at(self.of(node), reason))
    }

    fn fault(&mut self, node: Node<'_, '_>, reason: Reason) {
        let place = self.of(node);
        self.findings.fault(TreeError::at(place, reason));
    }

    fn document(&mut self) -> Result<Document, TreeError> {
        let root = self.xml.root_element();
        let is_foreign = |node: &Node<'_, '_>| {
            let has_prefix = node.attributes().any(|attribute| attribute.namespace().is_some());
            node.tag_name().namespace().is_some() || has_prefix && *node != root
        };
        if let Some(foreign) = root.descendants().filter(Node::is_element).find(is_foreign) {
            return self.refuse(foreign, Reason::Misplaced(name(foreign).to_owned()));
        }
        if name(root) != "root" {
            return self.refuse(root, Reason::NotTrees(name(root).to_owned()));
        }
        let mut document = Document::default();
        for (prefix, uri) in root.namespaces().filter_map(|declared| Some((declared.name()?, declared.uri()))) {
            document.notes.push(Attribute { place: self.of(root), ..Attribute::new(&format!("xmlns:{prefix}"), uri) });
        }
        let mut format = None;
        for attribute in self.attributes(root) {
            match attribute.name.as_str() {
                "BTCPP_format" => format = Some(attribute.value),
                "main_tree_to_execute" => document.main = Some(attribute.value),
                _ => document.notes.push(attribute),
            }
        }
        match format {
            Some(format) if format == "4" => {}
            Some(format) => self.fault(root, Reason::Format(format)),
            None => self.fault(root, Reason::NoFormat),
        }
        let (mut nameless, mut has_models) = (0, false);
        for child in self.elements(root) {
            match name(child) {
                "BehaviorTree" if document.trees.len() == MOST_TREES => {
                    return self.refuse(child, Reason::TooMany { what: "trees in one file", most: MOST_TREES });
                }
                "BehaviorTree" => document.trees.push(self.tree(child, &mut nameless)?),
                "TreeNodesModel" => {
                    if std::mem::replace(&mut has_models, true) {
                        self.fault(child, Reason::SecondModel);
                    }
                    self.models(child, &mut document)?;
                }
                "include" => document.includes.push(self.kept(child, 0)?),
                other => self.fault(child, Reason::Misplaced(other.to_owned())),
            }
        }
        if document.trees.is_empty() && document.includes.is_empty() && document.models.is_empty() {
            self.fault(root, Reason::NoTree);
        }
        Ok(document)
    }

    /// Reads a tree. A tree without an ID gets the same name as in BehaviorTree.CPP.
    fn tree(&mut self, node: Node<'x, 'x>, nameless: &mut u32) -> Result<TreeDefinition, TreeError> {
        let given = if node.has_attribute("ID") { self.with_id(node) } else { None };
        let (id, notes) = given.unwrap_or_else(|| {
            *nameless += 1;
            (format!("BehaviorTree_{}", *nameless - 1), self.attributes(node))
        });
        let (place, children) = (self.of(node), self.elements(node));
        if children.len() != 1 {
            self.fault(node, Reason::Roots { id: id.clone(), count: children.len() });
        }
        let root = match children.first() {
            Some(root) => self.element(*root, 0)?,
            // A placeholder for the missing node. The fault was already reported.
            None => Element { place, ..Element::new("AlwaysSuccess", Vec::new()) },
        };
        Ok(TreeDefinition { id, notes, root, place })
    }

    fn element(&mut self, node: Node<'x, 'x>, depth: usize) -> Result<Element, TreeError> {
        if depth >= DEEPEST {
            return self.refuse(node, Reason::TooDeep);
        }
        let place = self.of(node);
        let mut attributes = self.attributes(node);
        let mut take = |name: &str| {
            let at = attributes.iter().position(|attribute| attribute.name == name)?;
            Some(attributes.remove(at).value)
        };
        let (given_id, element_name) = (take("ID"), take("name"));
        let form = Form::ALL.into_iter().find(|form| form.word() == name(node)).unwrap_or(Form::Compact);
        if form == Form::Compact && given_id.is_some() && format_4_name(name(node)).is_none() {
            self.fault(node, Reason::NeedlessId(name(node).to_owned()));
        }
        let id = if form == Form::Compact { name(node).to_owned() } else { given_id.unwrap_or_default() };
        if id.is_empty() {
            self.fault(node, Reason::NoId(name(node).to_owned()));
        }
        let children = self.elements(node).into_iter().map(|child| self.element(child, depth + 1));
        let children = children.collect::<Result<Vec<Element>, TreeError>>()?;
        Ok(Element { id, form, name: element_name, attributes, children, place })
    }

    fn models(&mut self, node: Node<'x, 'x>, document: &mut Document) -> Result<(), TreeError> {
        for child in self.elements(node) {
            let form = Form::ALL.into_iter().find(|form| *form != Form::Compact && form.word() == name(child));
            let Some(form) = form else {
                document.kept.push(self.kept(child, 0)?);
                continue;
            };
            if document.models.len() == MOST_MODELS {
                return self.refuse(child, Reason::TooMany { what: "models in one file", most: MOST_MODELS });
            }
            let Some((id, notes)) = self.with_id(child) else { continue };
            if document.models.iter().any(|model| model.id == id) {
                self.fault(child, Reason::TwiceId(id.clone()));
            }
            let (mut ports, mut kept) = (Vec::new(), Vec::new());
            for part in self.elements(child) {
                // navigation2 uses a different word for ports that are read and written.
                let word = if name(part) == "bidirectional_port" { Direction::InOut.word() } else { name(part) };
                match Direction::ALL.into_iter().find(|direction| direction.word() == word) {
                    Some(direction) => ports.extend(self.model_port(part, direction)),
                    None => kept.push(self.kept(part, 0)?),
                }
            }
            if ports.len() > MOST_PORTS {
                return self.refuse(child, Reason::TooMany { what: "ports in one model", most: MOST_PORTS });
            }
            document.models.push(Model { form, id, notes, ports, kept, place: self.of(child) });
        }
        Ok(())
    }

    fn model_port(&mut self, node: Node<'x, 'x>, direction: Direction) -> Option<ModelPort> {
        let mut notes = self.attributes(node);
        let Some(at) = notes.iter().position(|note| note.name == "name") else {
            self.fault(node, Reason::NoName(name(node).to_owned()));
            return None;
        };
        let port = notes.remove(at).value;
        if let Some(child) = node.children().find(Node::is_element) {
            self.fault(child, Reason::Misplaced(name(child).to_owned()));
        }
        Some(ModelPort { direction, name: port, notes, text: text(node), place: self.of(node) })
    }

    /// Copies an element with all its contents, without interpreting them.
    fn kept(&mut self, node: Node<'x, 'x>, depth: usize) -> Result<Kept, TreeError> {
        if depth >= DEEPEST {
            return self.refuse(node, Reason::TooDeep);
        }
        let children = node.children().filter(Node::is_element).map(|child| self.kept(child, depth + 1));
        let children = children.collect::<Result<Vec<Kept>, TreeError>>()?;
        let (attributes, place) = (self.attributes(node), self.of(node));
        Ok(Kept { name: name(node).to_owned(), attributes, text: text(node), children, place })
    }

    /// Returns the ID of an element, and its other attributes. A missing ID is reported as a fault.
    fn with_id(&mut self, node: Node<'x, 'x>) -> Option<(String, Vec<Attribute>)> {
        let mut notes = self.attributes(node);
        let at = notes.iter().position(|note| note.name == "ID" && !note.value.is_empty());
        if at.is_none() {
            self.fault(node, Reason::NoId(name(node).to_owned()));
        }
        Some((notes.remove(at?).value, notes))
    }

    fn attributes(&self, node: Node<'_, '_>) -> Vec<Attribute> {
        let attribute = |attribute: roxmltree::Attribute<'_, '_>| Attribute {
            // The name, including its prefix.
            name: self.lines.text[attribute.range_qname()].to_owned(),
            value: attribute.value().to_owned(),
            place: self.lines.place(attribute.range().start),
        };
        node.attributes().map(attribute).collect()
    }

    /// Returns the elements inside an element. Comments are ignored, and texts are faults.
    fn elements(&mut self, node: Node<'x, 'x>) -> Vec<Node<'x, 'x>> {
        let mut elements = Vec::new();
        for child in node.children() {
            if child.is_element() {
                elements.push(child);
            } else if let Some(text) = child.text().filter(|text| child.is_text() && !text.trim().is_empty()) {
                self.fault(child, Reason::Text(text.trim().chars().take(40).collect()));
            }
        }
        elements
    }
}

fn name<'n>(node: Node<'n, '_>) -> &'n str {
    node.tag_name().name()
}

fn text(node: Node<'_, '_>) -> String {
    let text: String = node.children().filter_map(|child| child.text().filter(|_| child.is_text())).collect();
    text.trim().to_owned()
}
