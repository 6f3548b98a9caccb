//! Writes a document in a fixed layout, with all its contents except comments and processing instructions. Elements
//! are named by their IDs. In a document made by hand, these IDs must be valid XML names.

use crate::document::{Attribute, Document, Element, Form, Kept, Model, ModelPort};

/// Returns the text of a file with this document. Reading this text gives the same document.
#[must_use]
pub fn write(document: &Document) -> String {
    let mut writer = Writer { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), depth: 0 };
    let main = document.main.iter().map(|main| ("main_tree_to_execute", main.as_str()));
    let format = [("BTCPP_format", "4")].into_iter().chain(main);
    writer.within("root", &line(format, &document.notes), |writer| {
        document.includes.iter().for_each(|include| writer.kept(include));
        for tree in &document.trees {
            let attributes = line([("ID", tree.id.as_str())], &tree.notes);
            writer.within("BehaviorTree", &attributes, |writer| writer.element(&tree.root));
        }
        if !document.models.is_empty() || !document.kept.is_empty() {
            writer.within("TreeNodesModel", "", |writer| {
                document.models.iter().for_each(|model| writer.model(model));
                document.kept.iter().for_each(|kept| writer.kept(kept));
            });
        }
    });
    writer.text
}

struct Writer {
    text: String,
    depth: usize,
}

impl Writer {
    fn line(&mut self, line: &str) {
        self.text.push_str(&"  ".repeat(self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn within(&mut self, name: &str, attributes: &str, inner: impl FnOnce(&mut Writer)) {
        self.line(&format!("<{name}{attributes}>"));
        self.depth += 1;
        inner(self);
        self.depth -= 1;
        self.line(&format!("</{name}>"));
    }

    fn element(&mut self, element: &Element) {
        let (tag, id) = match element.form {
            Form::Compact => (element.id.as_str(), None),
            form @ (Form::Action | Form::Condition | Form::Control | Form::Decorator | Form::SubTree) => {
                (form.word(), Some(("ID", element.id.as_str())))
            }
        };
        let name = element.name.iter().map(|name| ("name", name.as_str()));
        let attributes = line(id.into_iter().chain(name), &element.attributes);
        self.perhaps_within(tag, &attributes, "", element.children.len(), |writer| {
            element.children.iter().for_each(|child| writer.element(child));
        });
    }

    fn model(&mut self, model: &Model) {
        let attributes = line([("ID", model.id.as_str())], &model.notes);
        self.perhaps_within(model.form.word(), &attributes, "", model.ports.len() + model.kept.len(), |writer| {
            model.ports.iter().for_each(|port| writer.port(port));
            model.kept.iter().for_each(|kept| writer.kept(kept));
        });
    }

    fn port(&mut self, port: &ModelPort) {
        let attributes = line([("name", port.name.as_str())], &port.notes);
        self.perhaps_within(port.direction.word(), &attributes, &port.text, 0, |_| ());
    }

    fn kept(&mut self, kept: &Kept) {
        let attributes = line([], &kept.attributes);
        self.perhaps_within(&kept.name, &attributes, &kept.text, kept.children.len(), |writer| {
            kept.children.iter().for_each(|child| writer.kept(child));
        });
    }

    /// Writes an element with a text and `others` further elements. If it has neither, it is written as a single tag.
    fn perhaps_within(&mut self, tag: &str, attributes: &str, text: &str, others: usize, inner: impl FnOnce(&mut Writer)) {
        match (text, others) {
            ("", 0) => self.line(&format!("<{tag}{attributes}/>")),
            (text, 0) => self.line(&format!("<{tag}{attributes}>{}</{tag}>", escaped(text))),
            (text, _) => self.within(tag, attributes, |writer| {
                if !text.is_empty() {
                    writer.line(&escaped(text));
                }
                inner(writer);
            }),
        }
    }
}

fn line<'a>(first: impl IntoIterator<Item = (&'a str, &'a str)>, others: &'a [Attribute]) -> String {
    let others = others.iter().map(|attribute| (attribute.name.as_str(), attribute.value.as_str()));
    first.into_iter().chain(others).map(|(name, value)| format!(" {name}=\"{}\"", escaped(value))).collect()
}

/// Escapes a text so that no part of it is read as a tag. Line breaks and tabs are preserved even in attributes.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\r' => escaped.push_str("&#13;"),
            '\t' => escaped.push_str("&#9;"),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::read;

    const FILE: &str = r#"<?xml version="1.0"?>
<root main_tree_to_execute="A" BTCPP_format="4" project_name="p">
  <!-- a comment -->
  <BehaviorTree ID="A" _description="first &amp; &quot;only&quot;">
    <Sequence name="all"><Action ID="Say" text="a &lt; b &#10; &#9;'c'" _onSuccess="x := 1 &amp;&amp; 0"/>
      <SubTree ID="B" goal="{here}" _autoremap="true"/>
      <Decorator ID="Inverter"><Condition ID="Near"/></Decorator></Sequence>
  </BehaviorTree>
  <BehaviorTree ID="B"><AlwaysSuccess/></BehaviorTree>
  <TreeNodesModel>
    <Action ID="Say" editable="true"><input_port name="text" type="std::string" default="hello">what <![CDATA[<it>]]> says</input_port></Action>
    <Condition ID="Near"/>
  </TreeNodesModel>
</root>"#;

    #[test]
    fn what_is_written_is_read_as_the_same_document() {
        let document = read(FILE).expect("it is a good file");
        let written = write(&document);
        assert_eq!(read(&written).expect("what is written can be read"), document);
        assert_eq!(write(&read(&written).expect("as before")), written);
        assert_eq!(document.trees[0].root.children[0].attribute("text").map(|text| text.value.as_str()), Some("a < b \n \t'c'"));
        assert_eq!(document.models[0].ports[0].text, "what <it> says");
    }
}
