//! The operation of a route, for programs, in the format of OpenAPI 3.1. Most problems of an operation follow from
//! its parts. For example, an operation with a body can get a malformed body, and a command can be refused.

use std::borrow::Cow;
use std::collections::BTreeSet;

use axum::http::Method;
use serde_json::{Map, Value, json};

use crate::access::Need;
use crate::api::problem::ProblemKind;
use hallsweep_core::command::CommandId;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Subject {
    Commands,
    State,
    Map,
    Missions,
    Simulator,
    Laboratory,
    Program,
    OldClients,
}

impl Subject {
    pub(super) const ALL: [Subject; 8] = [
        Subject::Commands,
        Subject::State,
        Subject::Map,
        Subject::Missions,
        Subject::Simulator,
        Subject::Laboratory,
        Subject::Program,
        Subject::OldClients,
    ];

    pub(super) const fn named(self) -> (&'static str, &'static str) {
        match self {
            Subject::Commands => ("commands", "Commands. The answer comes when the command is carried out or refused."),
            Subject::State => ("state", "The present state and its changes."),
            Subject::Map => ("map", "The explored part of the hall, as files for other programs."),
            Subject::Missions => ("missions", "All missions and their events."),
            Subject::Simulator => ("simulator", "Time, faults and hall of the simulator, if the searching robot is simulated."),
            Subject::Laboratory => ("laboratory", "Computed experiments, which do not affect the hall."),
            Subject::Program => ("program", "Health, metrics and description of the program."),
            Subject::OldClients => ("oldClients", "Commands of the old console; the path is the whole command."),
        }
    }
}

pub(super) struct Operation {
    pub(super) method: Method,
    pub(super) path: Cow<'static, str>,
    /// Name of the operation in generated client code.
    pub(super) id: Cow<'static, str>,
    pub(super) subject: Subject,
    pub(super) summary: Cow<'static, str>,
    pub(super) query: Vec<Parameter>,
    pub(super) headers: Vec<Parameter>,
    pub(super) body: Option<Body>,
    pub(super) answers: Vec<Media>,
    /// Whether the answer has a tag, and is omitted if the client already has that version.
    pub(super) is_tagged: bool,
    /// Possible problems that do not follow from the other fields.
    pub(super) also: Vec<ProblemKind>,
}

pub(super) struct Parameter {
    pub(super) name: &'static str,
    pub(super) what: &'static str,
    pub(super) schema: Value,
}

pub(super) struct Body {
    pub(super) media_types: &'static [&'static str],
    pub(super) schema: Value,
    pub(super) is_needed: bool,
}

/// A media type, and its schema if it is JSON.
pub(super) type Media = (&'static str, Value);

impl Operation {
    pub(super) fn new(
        method: Method,
        path: impl Into<Cow<'static, str>>,
        id: impl Into<Cow<'static, str>>,
        subject: Subject,
        summary: impl Into<Cow<'static, str>>,
    ) -> Operation {
        Operation {
            method,
            path: path.into(),
            id: id.into(),
            subject,
            summary: summary.into(),
            query: Vec::new(),
            headers: Vec::new(),
            body: None,
            answers: Vec::new(),
            is_tagged: false,
            also: Vec::new(),
        }
    }

    pub(super) fn answers(mut self, media_type: &'static str, schema: Value) -> Operation {
        self.answers.push((media_type, schema));
        self
    }

    pub(super) fn asked(mut self, name: &'static str, what: &'static str, schema: Value) -> Operation {
        self.query.push(Parameter { name, what, schema });
        self
    }

    pub(super) fn takes(self, media_types: &'static [&'static str], schema: Value, is_needed: bool) -> Operation {
        Operation { body: Some(Body { media_types, schema, is_needed }), ..self }
    }

    pub(super) fn told(mut self, name: &'static str, what: &'static str, schema: Value) -> Operation {
        self.headers.push(Parameter { name, what, schema });
        self
    }

    pub(super) fn tagged(self) -> Operation {
        let what = "`ETag` of the version that the client has; this version is not sent again.";
        Operation { is_tagged: true, ..self.told("If-None-Match", what, json!({"type": "string"})) }
    }

    /// Adds the header with the command id. A command that is sent again with the same id has no further effect. A
    /// STOP halts every time.
    pub(super) fn once(self, is_stop: bool) -> Operation {
        let what = if is_stop {
            "Name of this command. A STOP halts each time, whatever its name is."
        } else {
            "Name of this command. A copy with the same name has no further effect and gets the same answer."
        };
        let name = json!({"type": "string", "pattern": format!("^[!-~]{{1,{}}}$", CommandId::MOST)});
        let schema = if is_stop { json!({"type": "string"}) } else { name };
        self.told("Idempotency-Key", what, schema)
    }

    pub(super) fn also(mut self, also: &[ProblemKind]) -> Operation {
        self.also.extend(also);
        self
    }

    pub(super) fn problems(&self, need: Need) -> BTreeSet<(u16, &'static str)> {
        use ProblemKind::{
            Conflict, Forbidden, Internal, Malformed, Misdirected, NotAcceptable, NotFound, NotSignedIn, TooLarge, TooSlow,
            Unavailable, UnsupportedFormat, Unusable,
        };
        let changes = self.method != Method::GET;
        let is_command = self.headers.iter().any(|header| header.name == "Idempotency-Key");
        let parts: [(bool, &[ProblemKind]); 8] = [
            (true, &[Misdirected, Internal, Unavailable]),
            (need != Need::Nothing, &[NotSignedIn]),
            (changes, &[Forbidden]),
            (self.path.contains('{'), &[NotFound]),
            (!self.query.is_empty(), &[Unusable]),
            (self.body.is_some(), &[Malformed, TooSlow, TooLarge, UnsupportedFormat, Unusable]),
            (is_command, &[Malformed, Conflict, Unusable]),
            (self.answers.len() > 1, &[NotAcceptable]),
        ];
        let follow = parts.into_iter().filter(|(so, _)| *so).flat_map(|(_, kinds)| kinds);
        follow.chain(&self.also).map(|kind| kind.status()).collect()
    }

    /// Returns the operation in the format of OpenAPI. `asks` says whether keys are required.
    pub(super) fn written(&self, need: Need, asks: bool) -> Value {
        let (subject, _) = self.subject.named();
        let parameter = |(place, name, what, schema)| {
            let is_needed = place == "path";
            json!({"name": name, "in": place, "required": is_needed, "description": what, "schema": schema})
        };
        let parameters: Vec<Value> = self.parameters().into_iter().map(parameter).collect();
        let mut operation = json!({
            "operationId": self.id,
            "tags": [subject],
            "summary": self.summary,
            "description": format!("Allowed for: {}.", need.in_words()),
            "parameters": parameters,
            "responses": self.responses(need),
        });
        if let Some(Body { media_types, schema, is_needed }) = &self.body {
            let content: Map<String, Value> =
                media_types.iter().map(|media_type| ((*media_type).to_owned(), json!({"schema": schema}))).collect();
            operation["requestBody"] = json!({"required": is_needed, "content": content});
        }
        if self.subject == Subject::OldClients {
            operation["deprecated"] = true.into();
        }
        if need != Need::Nothing {
            operation["security"] = if asks { json!([{"token": []}]) } else { json!([{}, {"token": []}]) };
        }
        operation
    }

    /// Returns the parameters outside the body, each with place, name, description and schema.
    pub(super) fn parameters(&self) -> Vec<(&'static str, &str, &str, Value)> {
        let in_path = self.path.split('{').skip(1).filter_map(|rest| rest.split('}').next());
        let schema = |name| match name {
            "id" => json!({"type": "integer", "minimum": 0, "maximum": u64::MAX}),
            _ => json!({"type": "string", "pattern": "^[a-z0-9][a-z0-9-]{0,39}$"}),
        };
        let which = |name| match name {
            "id" => "Number of the piece, alarm or mission.",
            _ => "Name of the hall.",
        };
        let of = |place| move |Parameter { name, what, schema }: &Parameter| (place, *name, *what, schema.clone());
        let rest = self.query.iter().map(of("query")).chain(self.headers.iter().map(of("header")));
        in_path.map(|name| ("path", name, which(name), schema(name))).chain(rest).collect()
    }

    fn responses(&self, need: Need) -> Map<String, Value> {
        let tag = json!({"ETag": {"$ref": "#/components/headers/ETag"}});
        let content: Map<String, Value> = self
            .answers
            .iter()
            .map(|(media_type, schema)| {
                ((*media_type).to_owned(), if schema.is_null() { json!({}) } else { json!({"schema": schema}) })
            })
            .collect();
        let mut success = json!({"description": "Success.", "content": content});
        if self.is_tagged {
            success["headers"] = tag.clone();
        }
        let mut responses = Map::from_iter([("200".to_owned(), success)]);
        if self.is_tagged {
            responses.insert("304".to_owned(), json!({"description": "The client has this version already.", "headers": tag}));
        }
        responses.insert("431".to_owned(), json!({"description": "The request head is too large; the answer has no body."}));
        let problem = |(status, title): (u16, &str)| {
            (status.to_string(), json!({"$ref": format!("#/components/responses/{}", name(title))}))
        };
        responses.extend(self.problems(need).into_iter().map(problem));
        responses
    }
}

pub(super) fn name(title: &str) -> String {
    title.split(' ').collect()
}

pub(super) fn problem(kind: ProblemKind, shape: &Value) -> (String, Value) {
    let (_, title) = kind.status();
    let mut answer = json!({"description": title, "content": {"application/problem+json": {"schema": shape}}});
    if kind == ProblemKind::NotSignedIn {
        answer["headers"] = json!({"WWW-Authenticate": {"required": true, "schema": {"type": "string"}}});
    }
    (name(title), answer)
}
