//! Counts how often each production of the grammar occurs in a text, from its tree and, for productions that the tree
//! does not contain, from the text.
//!
//! Productions are named as in [`crate::grammar`]. An optional part is counted where it is present. Units are counted
//! by name.

mod conditions;

use std::collections::BTreeMap;

use mdle_compiler::alphabet::Unit;
use mdle_compiler::diagnostic::{SourceId, Span};
use mdle_compiler::syntax::tree::{
    Arg, Atom, Call, Count, Element, Exec, File, Formal, Frame, Number, Param, Plan, Primary,
};

/// Number of occurrences of each production and of each unit.
pub type Productions = BTreeMap<&'static str, u64>;

/// Adds the productions and units of a text without errors to `counts`.
pub fn count(text: &str, file: &File<'_>, counts: &mut Productions) {
    let mut counter = Counter { text, counts };
    counter.met("File = Items?");
    counter.met("File … Items?");
    let items = file.uses.len() + file.plans.len();
    counter.list(items, "Items = Item", "Items = Items Item");
    file.uses.iter().for_each(|_| counter.met("Item = \"use\" Str"));
    for plan in &file.plans {
        counter.met("Item = Plan");
        counter.plan(plan);
    }
}

struct Counter<'t> {
    text: &'t str,
    counts: &'t mut Productions,
}

impl<'t> Counter<'t> {
    fn met(&mut self, production: &'static str) {
        *self.counts.entry(production).or_default() += 1;
    }

    /// Counts the productions of a list with `length` elements: `first` for the first element, and `further` for each
    /// following element.
    fn list(&mut self, length: usize, first: &'static str, further: &'static str) {
        for place in 0..length {
            self.met(if place == 0 { first } else { further });
        }
    }

    /// Counts the unit of a number, if it has one.
    fn number(&mut self, number: &Number<'_>) {
        if let Some(unit) = number.unit().and_then(Unit::from_name) {
            self.met(unit.name);
        }
    }

    /// Returns the text of a span.
    fn written(&self, span: Span) -> &'t str {
        &self.text[span.within(SourceId(0))]
    }

    /// Returns the text before a span, without trailing white space.
    fn before(&self, span: Span) -> &'t str {
        self.text[..span.within(SourceId(0)).start].trim_end()
    }

    fn plan(&mut self, plan: &Plan<'_>) {
        self.met("Plan = (Label \"=\")? \"{\" Head Elements? \"sigma_null\"? \"}\"");
        match plan.group {
            None => self.met("Head = Name Params? HeadCondition?"),
            Some(robots) => {
                self.met("Head = \"Group\" \"[\" ArgList? \"]\" Name Params? HeadCondition?");
                self.robots(robots);
            }
        }
        self.met("Plan … Elements?");
        if plan.label.is_some() {
            self.met("Plan … (Label \"=\")?");
        }
        let inside = self.written(plan.span).trim_end_matches('}').trim_end();
        if ["sigma_null", "σ_null"].iter().any(|null| inside.ends_with(null)) {
            self.met("Plan … \"sigma_null\"?");
        }
        if !plan.params.is_empty() {
            self.met("Head … Params?");
            self.met("Params = \"parameters (\" ParamList \")\"");
            self.list(plan.params.len(), "ParamList = Param", "ParamList = ParamList \",\" Param");
            plan.params.iter().for_each(|param| self.param(param));
        }
        if let Some(condition) = &plan.condition {
            self.met("Head … HeadCondition?");
            self.met("HeadCondition = \"condition (\" Or \")\"");
            self.or(condition);
        }
        self.elements(plan.elements);
    }

    /// Counts the productions of the robots of a group.
    fn robots(&mut self, robots: &[Arg<'_>]) {
        if !robots.is_empty() {
            self.met("Head … ArgList?");
        }
        self.list(robots.len(), "ArgList = Arg", "ArgList = ArgList \",\"? Arg");
        for robot in robots {
            if let Arg::Name(_) = robot {
                self.met("Arg = Name");
            }
        }
    }

    fn param(&mut self, param: &Param<'_>) {
        self.met("Param = Name \":\" Type");
        self.met("Type = TypeName (\"[\" Number \"]\")?");
        let written = param.type_name.node;
        if written.contains('[') {
            self.met("Type … (\"[\" Number \"]\")?");
        }
        self.met(if written == "module" { "TypeName = \"module\"" } else { "TypeName = Name" });
    }

    fn elements(&mut self, elements: &[Element<'_>]) {
        self.list(elements.len(), "Elements = Element", "Elements = Elements Element");
        elements.iter().for_each(|element| self.element(element));
    }

    fn element(&mut self, element: &Element<'_>) {
        self.met("Element = (Name \":\")? Frame? Primary (\"^\" Count)?");
        if element.label().is_some() {
            self.met("Element … (Name \":\")?");
        }
        if let Some(frame) = element.frame() {
            self.met("Element … Frame?");
            match frame {
                Frame::Turned(angle) => {
                    self.met("Frame = \"FRAME\" Number");
                    self.number(angle);
                }
                Frame::Here => self.met("Frame = \"FRAME\" \"here\""),
            }
        }
        if let Some(power) = element.power() {
            self.met("Element … (\"^\" Count)?");
            self.times(power);
        }
        match &element.primary {
            Primary::Atom(atom) => self.atom(atom),
            Primary::Plan(plan) => {
                self.met("Primary = Plan");
                self.plan(plan);
            }
            Primary::Ref(call) => {
                self.met("Primary = Ref");
                self.reference(call);
            }
            Primary::Exec(exec) => self.exec(exec),
            Primary::String(body) => {
                self.met("Primary = \"(\" Elements? \")\"");
                self.met("Primary … Elements?");
                self.elements(body);
            }
            Primary::Formal(formal) => self.formal(formal),
            Primary::Broken => {}
        }
    }

    fn atom(&mut self, atom: &Atom<'_>) {
        self.met("Primary = \"(\" \"Atom\" AtomCondition Control \")\"");
        self.met("AtomCondition = Parenthesized");
        self.parenthesized(&atom.condition);
        let is_in_parentheses = self.before(atom.control.span).ends_with('(');
        self.met(if is_in_parentheses { "Control = \"(\" Call \")\"" } else { "Control = Call" });
        self.call(atom.control);
    }

    fn exec(&mut self, exec: &Exec<'_>) {
        self.times(&exec.count);
        match exec.body {
            [Element { primary: Primary::Ref(call), span, .. }] if !self.before(*span).ends_with('{') => {
                self.met("Primary = \"ExecPlan\" Count Ref");
                self.reference(call);
            }
            body => {
                self.met("Primary = \"ExecPlan\" Count \"{\" Elements? \"}\"");
                self.elements(body);
            }
        }
    }

    fn formal(&mut self, formal: &Formal<'_>) {
        match formal.body {
            [Element { primary: Primary::Ref(law), .. }] if !law.args.is_empty() && !self.touches(law) => {
                self.met("Primary = \"(\" LawCall \",\" Or Timer? \")\"");
                self.law(law);
            }
            body => {
                self.met("Primary = \"(\" Elements? \",\" Or Timer? \")\"");
                self.elements(body);
            }
        }
        self.or_inside(&formal.condition);
        if let Some(time) = &formal.time {
            self.met("Primary … Timer?");
            match time {
                Arg::Number(number) => {
                    self.met("Timer = \",\" Number");
                    self.number(number);
                }
                Arg::Infinity(_) => self.met("Timer = \",\" Infinity"),
                Arg::Name(_) => self.met("Timer = \",\" Name"),
                Arg::String(_) | Arg::Module(_) => {}
            }
        }
    }

    fn law(&mut self, law: &Call<'_>) {
        let (first, rest) = law.args.split_first().expect("an argument");
        self.met(if rest.is_empty() { "LawCall = Name Literal" } else { "LawCall = Name Literal Args" });
        match first {
            Arg::Number(number) => {
                self.met("Literal = Number");
                self.number(number);
            }
            Arg::Infinity(_) => self.met("Literal = Infinity"),
            Arg::String(_) => self.met("Literal = Str"),
            Arg::Name(_) | Arg::Module(_) => {}
        }
        self.args(law, rest);
    }

    fn times(&mut self, count: &Count<'_>) {
        self.met(match count {
            Count::Number(_) => "Count = Number",
            Count::Infinity(_) => "Count = Infinity",
            Count::Name(_) => "Count = Name",
        });
    }
}
