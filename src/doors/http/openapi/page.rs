//! The description as a page for people: the operations by subject, and the schemas of the interface. The text around
//! them is in the reader's language. The operations and schemas are in English, like everything under `/api`.

use std::sync::LazyLock;

use askama::Template;
use axum::http::HeaderMap;
use axum::response::Response;
use serde_json::{Map, Value};

use super::super::console::html;
use super::super::language::Spoken;
use super::super::problem::Problem;
use super::described;
use super::kept::Kept;
use super::operation::{Body, Operation, Subject};
use crate::access::Need;
use crate::api::problem::ProblemJson;
use crate::api::schemas::Schemas;
use crate::phrases::Language;

static PAGES: LazyLock<Vec<(Language, Kept)>> = LazyLock::new(|| {
    let contents = &Contents::new();
    let page = |language| html(&OpenApiPage { language, contents }).0;
    Language::ALL.map(|language| (language, Kept::new("text/html; charset=utf-8", page(language)))).into()
});

pub(in super::super) async fn page(Spoken(language): Spoken, headers: HeaderMap) -> Result<Response, Problem> {
    let page = PAGES.iter().find(|(spoken, _)| *spoken == language);
    page.map(|(_, page)| page.sent(&headers)).ok_or_else(Problem::internal)
}

#[derive(Template)]
#[template(path = "api.html")]
struct OpenApiPage<'a> {
    language: Language,
    contents: &'a Contents,
}

struct Contents {
    subjects: Vec<About>,
    shapes: Vec<Shape>,
}

struct About {
    name: &'static str,
    what: &'static str,
    operations: Vec<Shown>,
}

struct Shown {
    method: String,
    path: String,
    id: String,
    summary: String,
    need: &'static str,
    parameters: Vec<Field>,
    body: Vec<MediaContent>,
    answers: Vec<MediaContent>,
    problems: Vec<(u16, &'static str)>,
}

struct Field {
    name: String,
    /// Where a parameter is sent, such as `query`. Empty for a field of a schema.
    place: &'static str,
    kind: Vec<Word>,
    what: String,
}

struct MediaContent {
    media_type: &'static str,
    kind: Vec<Word>,
}

struct Word {
    text: String,
    is_shape: bool,
}

struct Shape {
    name: String,
    what: String,
    kind: Vec<Word>,
    fields: Vec<Field>,
}

impl Contents {
    fn new() -> Contents {
        let mut schemas = Schemas::default();
        let rows = described(&mut schemas);
        let of = |subject: Subject| {
            let (name, what) = subject.named();
            let operations = rows.iter().filter(|(_, operation)| operation.subject == subject);
            About { name, what, operations: operations.map(|(row, operation)| Shown::new(operation, row.need)).collect() }
        };
        let subjects = Subject::ALL.map(of).into_iter().collect();
        let _ = schemas.sent::<ProblemJson<'static>>();
        Contents { subjects, shapes: schemas.shapes().into_iter().map(|(name, schema)| Shape::new(name, &schema)).collect() }
    }
}

impl Shown {
    fn new(operation: &Operation, need: Need) -> Shown {
        let field = |(place, name, what, schema): (&'static str, &str, &str, Value)| Field {
            name: name.to_owned(),
            place,
            kind: words(&schema),
            what: what.to_owned(),
        };
        let carried = |media_type: &&'static str, schema: &Value| MediaContent { media_type, kind: words(schema) };
        let body = operation.body.iter();
        Shown {
            method: operation.method.to_string(),
            path: operation.path.to_string(),
            id: operation.id.to_string(),
            summary: operation.summary.to_string(),
            need: need.in_words(),
            parameters: operation.parameters().into_iter().map(field).collect(),
            body: body
                .flat_map(|Body { media_types, schema, .. }| media_types.iter().map(|media_type| carried(media_type, schema)))
                .collect(),
            answers: operation.answers.iter().map(|(media_type, schema)| carried(media_type, schema)).collect(),
            problems: operation.problems(need).into_iter().collect(),
        }
    }
}

impl Shape {
    fn new(name: String, schema: &Value) -> Shape {
        let fields = schema["properties"].as_object().into_iter().flatten();
        let fields: Vec<Field> = fields
            .map(|(name, schema)| Field { name: name.clone(), place: "", kind: words(schema), what: said(schema) })
            .collect();
        let kind = if fields.is_empty() { words(schema) } else { Vec::new() };
        Shape { name, what: said(schema), kind, fields }
    }
}

fn said(schema: &Value) -> String {
    schema["description"].as_str().unwrap_or_default().replace('\n', " ")
}

fn words(schema: &Value) -> Vec<Word> {
    let plain = |text: String| vec![Word { text, is_shape: false }];
    let Some(fields) = schema.as_object() else { return Vec::new() };
    if let Some(name) = fields.get("$ref").and_then(Value::as_str).and_then(|to| to.rsplit('/').next()) {
        return vec![Word { text: name.to_owned(), is_shape: true }];
    }
    if let Some(word) = fields.get("const") {
        return plain(word.to_string());
    }
    if let Some(all) = fields.get("enum").and_then(Value::as_array) {
        return plain(
            all.iter().map(|word| word.as_str().map_or_else(|| word.to_string(), str::to_owned)).collect::<Vec<_>>().join(" | "),
        );
    }
    if let Some(forms) = ["oneOf", "anyOf"].iter().find_map(|key| fields.get(*key)?.as_array()) {
        return joined(forms.iter().map(words), " or ");
    }
    if let Some(items) = fields.get("prefixItems").and_then(Value::as_array) {
        return [plain("[".to_owned()), joined(items.iter().map(words), ", "), plain("]".to_owned())]
            .into_iter()
            .flatten()
            .collect();
    }
    let kinds: Vec<&str> = match fields.get("type") {
        Some(Value::String(kind)) => vec![kind],
        Some(Value::Array(kinds)) => kinds.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    joined(kinds.into_iter().map(|kind| of_kind(kind, fields)), " or ")
}

fn of_kind(kind: &str, fields: &Map<String, Value>) -> Vec<Word> {
    let plain = |text: String| vec![Word { text, is_shape: false }];
    match (kind, fields.get("items"), fields.get("properties").and_then(Value::as_object)) {
        ("array", Some(items), _) => plain("list of ".to_owned()).into_iter().chain(words(items)).collect(),
        ("object", _, Some(inner)) => {
            let field = |(name, schema): (&String, &Value)| plain(format!("{name}: ")).into_iter().chain(words(schema)).collect();
            [plain("{".to_owned()), joined(inner.iter().map(field), ", "), plain("}".to_owned())].into_iter().flatten().collect()
        }
        ("integer" | "number", ..) => match (fields.get("minimum"), fields.get("maximum")) {
            (Some(least), Some(most)) if most.as_f64().is_some_and(|most| most < 1e9) => {
                plain(format!("{kind}, {least} to {most}"))
            }
            (Some(least), _) => plain(format!("{kind} from {least}")),
            _ => plain(kind.to_owned()),
        },
        _ => plain(kind.to_owned()),
    }
}

fn joined(forms: impl Iterator<Item = Vec<Word>>, by: &str) -> Vec<Word> {
    let mut all = Vec::new();
    for form in forms {
        if !all.is_empty() {
            all.push(Word { text: by.to_owned(), is_shape: false });
        }
        all.extend(form);
    }
    all
}
