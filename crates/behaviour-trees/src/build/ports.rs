//! Binds the ports of a node and its scripts when a tree is built, so that a tick looks up no names.

use super::{Builder, to_u32};
use crate::blackboard::Slot;
use crate::document::{Attribute, Element, Form, Model};
use crate::error::{Reason, TreeError, format_4_name};
use crate::kind::{BuiltIn, BuiltInPort, Needed, PortForm};
use crate::leaf::{Binding, Direction, Port};
use crate::script::Script;
use crate::status::Status;
use crate::tree::{Conditions, NodeKind};
use crate::value::{Value, ValueType};

const CONDITIONS: [&str; 8] = ["_failureIf", "_successIf", "_skipIf", "_while", "_onSuccess", "_onFailure", "_onHalted", "_post"];

/// With this attribute, a subtree sees the names outside, except names that begin with `_`.
const AUTOREMAP: &str = "_autoremap";

/// Maximum number of parties of a barrier. Each party has an entry, and every tick reads these entries.
const MOST_PARTIES: usize = 16;

impl<'a> Builder<'a> {
    pub(super) fn bind(&mut self, element: &'a Element, kind: NodeKind, scope: usize, node: u32) {
        match kind {
            // The attributes of a subtree are handled by `enter`.
            NodeKind::BuiltIn(BuiltIn::SubTree) => {}
            NodeKind::BuiltIn(kind) => {
                self.known_ports(element, |name| kind.ports().iter().any(|port| port.name == name));
                if kind == BuiltIn::Sync {
                    let bound = self.bind_barrier(element, kind);
                    return self.told(bound).unwrap_or_default();
                }
                for port in kind.ports() {
                    let bound = self.built_in_port(element, port, scope, node);
                    let bound = bound.and_then(|binding| fitting(element, kind, port, &binding).map(|()| binding));
                    let binding = self.told(bound).unwrap_or(Binding::Unset);
                    self.shape.bindings.push(binding);
                }
            }
            NodeKind::Leaf(place) => {
                let ports = &self.catalogue.kinds()[place].ports;
                self.known_ports(element, |name| ports.iter().any(|port| port.name == name));
                for port in ports {
                    let bound = self.leaf_port(element, port, scope);
                    let binding = self.told(bound).unwrap_or(Binding::Unset);
                    self.shape.bindings.push(binding);
                }
            }
        }
    }

    pub(super) fn bind_declared(&mut self, element: &Element, model: &Model, scope: usize) {
        let port = |name: &str| model.ports.iter().find(|port| port.name == name);
        self.known_ports(element, |name| port(name).is_some());
        for port in given(element).filter_map(|attribute| port(&attribute.name)) {
            let bound = self.leaf_port(element, &Port::of_model(port), scope);
            self.told(bound);
        }
    }

    fn known_ports(&mut self, element: &Element, is_known: impl Fn(&str) -> bool) {
        for attribute in given(element).filter(|attribute| !is_known(&attribute.name)) {
            let reason = Reason::UnknownPort { id: element.id.clone(), port: attribute.name.clone() };
            self.findings.fault(TreeError::at(attribute.place, reason));
        }
    }

    fn told<T>(&mut self, result: Result<T, TreeError>) -> Option<T> {
        result.map_err(|fault| self.findings.fault(fault)).ok()
    }

    fn leaf_port(&mut self, element: &Element, port: &Port, scope: usize) -> Result<Binding, TreeError> {
        let attribute = element.attribute(&port.name);
        let place = attribute.map_or(element.place, |attribute| attribute.place);
        let Some(text) = attribute.map(|attribute| attribute.value.as_str()).or(port.default.as_deref()) else {
            return Ok(Binding::Unset);
        };
        if let Some(name) = pointer(&port.name, text) {
            let slot = self.scopes.declare(scope, name, port.ty, self.blackboard);
            return slot.map(Binding::Slot).map_err(|unfit| TreeError::at(place, unfit.into()));
        }
        if port.direction == Direction::Out {
            // BehaviorTree.CPP ignores a default that names no entry.
            if attribute.is_none() {
                return Ok(Binding::Unset);
            }
            return Err(TreeError::at(place, Reason::LiteralOutput(port.name.to_string())));
        }
        match Value::parse(text, port.ty) {
            Some(value) => Ok(Binding::Literal(value)),
            None => {
                let reason = Reason::Literal { port: port.name.to_string(), ty: port.ty, value: text.to_owned() };
                Err(TreeError::at(place, reason))
            }
        }
    }

    fn built_in_port(&mut self, element: &Element, port: &BuiltInPort, scope: usize, node: u32) -> Result<Binding, TreeError> {
        let attribute = element.attribute(port.name);
        let place = attribute.map_or(element.place, |attribute| attribute.place);
        let refuse = |reason| TreeError::at(place, reason);
        let text = match (attribute, port.needed) {
            (Some(attribute), _) => attribute.value.as_str(),
            (None, Needed::Otherwise(default)) => default,
            (None, Needed::No) => return Ok(Binding::Unset),
            (None, Needed::Yes) => {
                return Err(refuse(Reason::MissingPort { id: element.id.clone(), port: port.name.to_owned() }));
            }
        };
        let pointer = pointer(port.name, text);
        match (port.written, pointer) {
            (PortForm::EntryName, _) => {
                // The text, with or without braces, is the name itself: an entry that holds the name of another entry
                // is not supported. Only a name in braces creates the entry.
                let name = pointer.unwrap_or(text);
                let slot = match pointer {
                    Some(name) => self.scopes.declare(scope, name, ValueType::Any, self.blackboard),
                    None => self.blackboard.mention(&self.scopes.entry_name(scope, name)),
                };
                let slot = slot.map_err(|unfit| refuse(unfit.into()))?;
                // `UnsetBlackboard` reaches only the blackboard of its own tree.
                let is_out_of_reach = port.name == "key" && !self.scopes.is_own(scope, name);
                Ok(if is_out_of_reach { Binding::Unset } else { Binding::Slot(slot) })
            }
            (PortForm::Value(ty), Some(name)) => {
                let slot = self.scopes.declare(scope, name, ty, self.blackboard);
                slot.map(Binding::Slot).map_err(|unfit| refuse(unfit.into()))
            }
            (PortForm::Value(ty), None) => match Value::parse(text, ty) {
                Some(value) => Ok(Binding::Literal(value)),
                None => Err(refuse(Reason::Literal { port: port.name.to_owned(), ty, value: text.to_owned() })),
            },
            (PortForm::Literal, Some(_)) => Err(refuse(Reason::EntryForLiteral(port.name.to_owned()))),
            (PortForm::Output(ty), Some(name)) => {
                let slot = self.scopes.declare(scope, name, ty, self.blackboard);
                slot.map(Binding::Slot).map_err(|unfit| refuse(unfit.into()))
            }
            (PortForm::Output(_), None) => Err(refuse(Reason::LiteralOutput(port.name.to_owned()))),
            (PortForm::Literal, None) if matches!(port.name, "else" | "if_empty") => {
                let status = Status::named(text).filter(|status| *status != Status::Idle).ok_or_else(|| {
                    let wanted = "SUCCESS, FAILURE, RUNNING or SKIPPED";
                    refuse(Reason::Word { port: port.name.to_owned(), value: text.to_owned(), wanted })
                })?;
                self.shape.otherwise.push((node, status));
                Ok(Binding::Unset)
            }
            (PortForm::Literal, None) => {
                let script = self.script(&Attribute { place, ..Attribute::new(port.name, text) }, scope)?;
                self.shape.scripts.push((node, script));
                Ok(Binding::Unset)
            }
        }
    }

    /// Binds a barrier. The barrier has the name of its node. Each of its parties has an entry, which is true when
    /// the party has arrived.
    fn bind_barrier(&mut self, element: &Element, kind: BuiltIn) -> Result<(), TreeError> {
        let barrier = element.name.as_deref().unwrap_or(kind.word());
        let mut texts = [None, None];
        for (text, port) in texts.iter_mut().zip(kind.ports()) {
            *text = element.attribute(port.name);
            if let Some(attribute) = text
                && pointer(port.name, &attribute.value).is_some()
            {
                return Err(TreeError::at(attribute.place, Reason::EntryForLiteral(port.name.to_owned())));
            }
        }
        let [Some(parties), party] = texts else {
            return Err(TreeError::at(element.place, Reason::MissingPort { id: element.id.clone(), port: "parties".to_owned() }));
        };
        let names: Vec<&str> = parties.value.split(';').map(str::trim).collect();
        let is_bad = |name: &&str| name.is_empty() || names.iter().filter(|other| *other == name).count() > 1;
        if names.len() > MOST_PARTIES || names.iter().any(is_bad) {
            let wanted = "1 to 16 different names, separated by ;";
            let reason = Reason::Word { port: "parties".to_owned(), value: parties.value.clone(), wanted };
            return Err(TreeError::at(parties.place, reason));
        }
        let prefix = format!("sync/{barrier}/");
        let refuse = |unfit| TreeError::at(element.place, Reason::Unfit(unfit));
        let there = self.blackboard.entries().filter_map(|entry| entry.name().strip_prefix(&prefix));
        let there: Vec<&str> = there.collect();
        if !there.is_empty() && (there.len() != names.len() || names.iter().any(|name| !there.contains(name))) {
            return Err(TreeError::at(parties.place, Reason::Parties(barrier.to_owned())));
        }
        let mut bindings = vec![Binding::Unset];
        for name in names {
            let slot = self.blackboard.declare(&format!("{prefix}{name}"), ValueType::Bool).map_err(refuse)?;
            if party.is_some_and(|party| party.value.trim() == name) {
                bindings[0] = Binding::Slot(slot);
            }
            bindings.push(Binding::Slot(slot));
        }
        self.shape.bindings.append(&mut bindings);
        Ok(())
    }

    pub(super) fn conditions(&mut self, element: &Element, scope: usize) -> Option<u32> {
        let mut conditions = Conditions::default();
        let mut are_some = false;
        for attribute in element.attributes.iter().filter(|attribute| attribute.name.starts_with('_')) {
            let place = match attribute.name.as_str() {
                "_failureIf" => &mut conditions.failure_if,
                "_successIf" => &mut conditions.success_if,
                "_skipIf" => &mut conditions.skip_if,
                "_while" => &mut conditions.keep_while,
                "_onSuccess" => &mut conditions.on_success,
                "_onFailure" => &mut conditions.on_failure,
                "_onHalted" => &mut conditions.on_halted,
                "_post" => &mut conditions.post,
                // Any other attribute of this form is a note of the editor. If it resembles a condition, it is
                // refused, because ignoring a misspelt condition would be dangerous.
                other => {
                    if let Some(reason) = looks_like(other) {
                        self.findings.fault(TreeError::at(attribute.place, reason));
                    }
                    continue;
                }
            };
            let script = self.script(attribute, scope);
            *place = self.told(script);
            are_some = true;
        }
        if !are_some {
            return None;
        }
        self.shape.conditions.push(conditions);
        Some(to_u32(self.shape.conditions.len() - 1))
    }

    fn script(&mut self, attribute: &Attribute, scope: usize) -> Result<Script, TreeError> {
        let (scopes, blackboard) = (&self.scopes, &mut *self.blackboard);
        let script = Script::parse(&attribute.value, &mut |name| blackboard.mention(&scopes.entry_name(scope, name)));
        script.map_err(|error| TreeError::at(attribute.place, Reason::Script { attribute: attribute.name.clone(), error }))
    }

    /// Opens the scope of a subtree with the ports of its `<SubTree>`. Ports that are missing there are taken from
    /// the model of the tree. Returns the scope, and the slots of the subtree's own entries to which a text was
    /// written.
    pub(super) fn enter(&mut self, element: &Element, scope: usize, path: &str) -> (usize, Vec<Slot>) {
        let has_autoremap = element.attribute(AUTOREMAP).is_some_and(|attribute| {
            let truth = Value::parse(&attribute.value, ValueType::Bool).and_then(|value| value.as_bool());
            truth.unwrap_or_else(|| {
                let reason = Reason::Literal { port: AUTOREMAP.to_owned(), ty: ValueType::Bool, value: attribute.value.clone() };
                self.findings.fault(TreeError::at(attribute.place, reason));
                false
            })
        });
        let inner = self.scopes.enter(scope, path, has_autoremap);
        let mut texts = Vec::new();
        for attribute in given(element) {
            texts.extend(self.outer(inner, attribute));
        }
        let (document, catalogue) = (self.document, self.catalogue);
        let is_meant = |model: &&Model| model.form == Form::SubTree && model.id == element.id;
        let model = document.models.iter().find(is_meant).or_else(|| catalogue.declared(&element.id).filter(is_meant));
        let ports = model.map_or(&[][..], |model| &model.ports);
        for port in ports.iter().filter(|port| !has_autoremap && element.attribute(&port.name).is_none()) {
            match Port::of_model(port).default {
                Some(default) => {
                    let attribute = Attribute { place: element.place, ..Attribute::new(&port.name, &default) };
                    texts.extend(self.outer(inner, &attribute));
                }
                None => {
                    let reason = Reason::MissingPort { id: element.id.clone(), port: port.name.clone() };
                    self.findings.fault(TreeError::at(element.place, reason));
                }
            }
        }
        (inner, texts)
    }

    /// Binds a name of a subtree to an entry outside. If the value is a text, writes the text to an entry of the
    /// subtree and returns its slot.
    fn outer(&mut self, inner: usize, attribute: &Attribute) -> Option<Slot> {
        if let Some(outside) = pointer(&attribute.name, &attribute.value) {
            self.scopes.remap(inner, &attribute.name, outside);
            return None;
        }
        self.scopes.own(inner, &attribute.name);
        let slot = self.scopes.declare(inner, &attribute.name, ValueType::Any, self.blackboard);
        let put = slot.and_then(|slot| self.blackboard.put(slot, Value::text(&attribute.value)).map(|()| slot));
        self.told(put.map_err(|unfit| TreeError::at(attribute.place, unfit.into())))
    }
}

/// Returns the probable meaning of a misspelt attribute. It may be a condition or `_autoremap` with wrong capitals or
/// underscores, or an attribute of format 3.
fn looks_like(written: &str) -> Option<Reason> {
    if let Some(now) = format_4_name(written) {
        return Some(Reason::Format3 { written: written.to_owned(), now });
    }
    let letters = |name: &str| name.replace('_', "").to_ascii_lowercase();
    let meant = CONDITIONS.into_iter().chain([AUTOREMAP]).find(|known| letters(known) == letters(written))?;
    (meant != written).then(|| Reason::Misspelt { written: written.to_owned(), meant })
}

/// Checks more than the type of a literal: no time may be negative, and the elements of a queue must have the type of
/// the loop.
fn fitting(element: &Element, kind: BuiltIn, port: &BuiltInPort, binding: &Binding) -> Result<(), TreeError> {
    let place = element.attribute(port.name).map_or(element.place, |attribute| attribute.place);
    let name = || port.name.to_owned();
    match binding {
        Binding::Literal(Value::Int(time)) if *time < 0 && matches!(port.name, "msec" | "delay_msec") => {
            Err(TreeError::at(place, Reason::Word { port: name(), value: time.to_string(), wanted: "0 or more" }))
        }
        Binding::Literal(Value::Text(queue)) if port.name == "queue" => {
            let ty = kind.element().unwrap_or_default();
            match queue.split_terminator(';').find(|element| Value::parse(element, ty).is_none()) {
                Some(wrong) => Err(TreeError::at(place, Reason::Literal { port: name(), ty, value: wrong.to_owned() })),
                None => Ok(()),
            }
        }
        Binding::Literal(_) | Binding::Slot(_) | Binding::Unset => Ok(()),
    }
}

/// Returns the attributes that are ports. These are all attributes that do not begin with `_`.
fn given(element: &Element) -> impl Iterator<Item = &Attribute> {
    element.attributes.iter().filter(|attribute| !attribute.name.starts_with('_'))
}

/// Returns the entry that a text names, such as `{goal}`. `{=}` and `=` mean the entry with the name of the port.
fn pointer<'t>(port: &'t str, text: &'t str) -> Option<&'t str> {
    let text = text.trim_matches(' ');
    if text == "=" {
        return Some(port);
    }
    let name = text.strip_prefix('{')?.strip_suffix('}')?;
    match name {
        "" => None,
        "=" => Some(port),
        name => Some(name),
    }
}
