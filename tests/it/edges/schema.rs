//! The part of JSON Schema that the schemas of requests use.

use planish::http::document_text;
use serde_json::Value;

/// The OpenAPI document, with a walk through its schemas.
pub(super) struct Document(Value);

impl Document {
    pub(super) fn new() -> Self {
        Self(serde_json::from_str(&document_text()).unwrap())
    }

    /// Returns the schema of this name.
    pub(super) fn named(&self, name: &str) -> &Value {
        &self.0["components"]["schemas"][name]
    }

    /// Returns the schema that a reference denotes, or the schema itself.
    fn meant<'a>(&'a self, schema: &'a Value) -> &'a Value {
        match schema["$ref"].as_str() {
            Some(reference) => self.0.pointer(&reference[1..]).unwrap(),
            None => schema,
        }
    }

    /// Whether a schema accepts a value; patterns are not checked.
    pub(super) fn takes(&self, schema: &Value, value: &Value) -> bool {
        let schema = self.meant(schema);
        if let Some(either) = schema["oneOf"].as_array() {
            return either.iter().any(|one| self.takes(one, value));
        }
        let is = |kind: &Value| match kind.as_str().unwrap() {
            "null" => value.is_null(),
            "boolean" => value.is_boolean(),
            "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
            "number" => value.is_number(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            other => panic!("{other} is no type"),
        };
        let kinds = &schema["type"];
        let fits = kinds.as_array().map_or_else(|| kinds.is_null() || is(kinds), |kinds| kinds.iter().any(is));
        fits && schema["enum"].as_array().is_none_or(|known| known.contains(value))
            && within(schema, value)
            && value.as_array().is_none_or(|items| items.iter().all(|item| self.takes(&schema["items"], item)))
            && value.as_object().is_none_or(|_| self.takes_fields(schema, value))
    }

    fn takes_fields(&self, schema: &Value, value: &Value) -> bool {
        let required = schema["required"].as_array().into_iter().flatten();
        let has = |name: &Value| value.get(name.as_str().unwrap()).is_some();
        let fits = |(name, value): (&String, &Value)| match schema["properties"].get(name) {
            Some(schema) => self.takes(schema, value),
            None if schema["additionalProperties"].is_object() => self.takes(&schema["additionalProperties"], value),
            None => schema["additionalProperties"] != false,
        };
        required.clone().all(has) && value.as_object().unwrap().iter().all(fits)
    }

    /// Returns every place within a value that has a schema, with that schema: fields, and first entries of lists.
    pub(super) fn places<'a>(
        &'a self,
        schema: &'a Value,
        value: &Value,
        at: &str,
        found: &mut Vec<(String, &'a Value)>,
    ) {
        let schema = self.meant(schema);
        for one in schema["oneOf"].as_array().into_iter().flatten().filter(|one| self.takes(one, value)) {
            self.places(one, value, at, found);
        }
        let fields = schema["properties"].as_object().into_iter().flatten();
        let fields = fields.filter_map(|(name, field)| Some((name.as_str(), field, value.get(name)?)));
        let first = value.get(0).filter(|_| schema["items"].is_object()).map(|first| ("0", &schema["items"], first));
        for (name, schema, value) in fields.chain(first) {
            let at = format!("{at}/{name}");
            found.push((at.clone(), schema));
            self.places(schema, value, &at, found);
        }
    }

    /// Collects every place that values of a schema can have, except for the fields of alternatives that a field
    /// chooses by name.
    pub(super) fn possible(&self, schema: &Value, at: &str, found: &mut Vec<String>) {
        let schema = self.meant(schema);
        if !schema["discriminator"].is_null() {
            return;
        }
        for one in schema["oneOf"].as_array().into_iter().flatten() {
            self.possible(one, at, found);
        }
        let fields = schema["properties"].as_object().into_iter().flatten().map(|(name, field)| (name.as_str(), field));
        for (name, schema) in fields.chain(schema["items"].is_object().then(|| ("0", &schema["items"]))) {
            let at = format!("{at}/{name}");
            found.push(at.clone());
            // the parameters of a word are open; figures contain jobs, and `distance_to` is another job
            if !["/plan/parameters", "/figure", "/distance_to"].contains(&at.as_str()) {
                self.possible(schema, &at, found);
            }
        }
    }
}

fn within(schema: &Value, value: &Value) -> bool {
    let length = |least: &str, most: &str, n: usize| {
        schema[least].as_u64().is_none_or(|least| n as u64 >= least)
            && schema[most].as_u64().is_none_or(|most| n as u64 <= most)
    };
    let ranged = value.as_f64().is_none_or(|x| {
        schema["minimum"].as_f64().is_none_or(|least| x >= least)
            && schema["maximum"].as_f64().is_none_or(|most| x <= most)
            && schema["exclusiveMinimum"].as_f64().is_none_or(|beyond| x > beyond)
    });
    let written = value.as_str().is_none_or(|text| length("minLength", "maxLength", text.chars().count()));
    ranged && written && value.as_array().is_none_or(|items| length("minItems", "maxItems", items.len()))
}
