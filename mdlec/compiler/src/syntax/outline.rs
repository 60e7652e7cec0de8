//! Prints the tree of a file as an outline, with one line for each node; names are not resolved.

use super::tree::{
    Arg, Call, Condition, ConditionNode, Count, Element, File, Frame, Number, Operand, Param, Plan, Primary,
};

/// Returns the outline of a file, indented by two spaces for each level.
#[must_use]
pub fn outline(file: &File<'_>) -> String {
    let mut outline = OutlineText { text: String::new(), depth: 0 };
    file.uses.iter().for_each(|used| outline.line(&format!("use {:?}", used.node)));
    file.plans.iter().for_each(|plan| outline.plan(plan));
    outline.text
}

struct OutlineText {
    text: String,
    depth: usize,
}

impl OutlineText {
    fn line(&mut self, line: &str) {
        self.text += &format!("{:indent$}{line}\n", "", indent = 2 * self.depth);
    }

    fn plan(&mut self, plan: &Plan<'_>) {
        let label = plan.label.as_ref().map(|label| format!("{} = ", label.node)).unwrap_or_default();
        let params: Vec<_> = plan.params.iter().map(param).collect();
        let params = if params.is_empty() { String::new() } else { format!("({})", params.join(", ")) };
        let when = plan.condition.as_ref().map(|when| format!(" when {}", condition(when))).unwrap_or_default();
        plan.docs.iter().for_each(|doc| self.line(&format!("///{doc}")));
        let robots = plan.group.map(|robots| robots.iter().map(arg).collect::<Vec<_>>().join(" "));
        let group = robots.map(|robots| format!(" of the group {robots}")).unwrap_or_default();
        self.line(&format!("plan {label}{}{group}{params}{when}", plan.name.node));
        self.elements(plan.elements);
    }

    fn elements(&mut self, elements: &[Element<'_>]) {
        self.depth += 1;
        elements.iter().for_each(|element| self.element(element));
        self.depth -= 1;
    }

    fn element(&mut self, element: &Element<'_>) {
        let label = element.label().map(|label| format!("{}: ", label.node)).unwrap_or_default();
        let frame = element.frame().map(|frame| match frame {
            Frame::Turned(angle) => format!("frame {} ", number(angle)),
            Frame::Here => "frame here ".to_owned(),
        });
        let frame = frame.unwrap_or_default();
        let power = element.power().map(|power| format!(" ^ {}", count(power))).unwrap_or_default();
        let head = format!("{label}{frame}");
        match &element.primary {
            Primary::Atom(atom) => {
                let (when, law) = (condition(&atom.condition), call(atom.control));
                self.line(&format!("{head}atom when {when} do {law}{power}"));
            }
            Primary::Plan(plan) => {
                if !head.is_empty() || !power.is_empty() {
                    self.line(&format!("{head}behavior{power}"));
                }
                self.plan(plan);
            }
            Primary::Ref(plan) => self.line(&format!("{head}run {}{power}", call(plan))),
            Primary::Exec(exec) => {
                self.line(&format!("{head}loop {}{power}", count(&exec.count)));
                self.elements(exec.body);
            }
            Primary::String(body) => {
                self.line(&format!("{head}string{power}"));
                self.elements(body);
            }
            Primary::Formal(formal) => {
                let time = formal.time.as_ref().map(|time| format!(", {}", arg(time))).unwrap_or_default();
                self.line(&format!("{head}formal when {}{time}{power}", condition(&formal.condition)));
                self.elements(formal.body);
            }
            Primary::Broken => self.line(&format!("{head}(could not be read){power}")),
        }
    }
}

fn param(param: &Param<'_>) -> String {
    format!("{}: {}", param.name.node, param.type_name.node)
}

fn condition(written: &Condition<'_>) -> String {
    let all = |word: &str, operands: &[Condition<'_>]| {
        let operands: Vec<_> = operands.iter().map(condition).collect();
        format!("({})", operands.join(word))
    };
    match &written.node {
        ConditionNode::Or(operands) => all(" OR ", operands),
        ConditionNode::And(operands) => all(" AND ", operands),
        ConditionNode::Not(operand) => format!("NOT {}", condition(operand)),
        ConditionNode::Rising(operand) => format!("RISING {}", condition(operand)),
        ConditionNode::Call(quark) => format!("({})", call(quark)),
        ConditionNode::Comparison(compared) => {
            let right = match &compared.right {
                Operand::Signal(signal) => call(signal),
                Operand::Number(value) => number(value),
                Operand::Infinity(_) => "inf".into(),
            };
            format!("({} {} {right})", call(compared.left), compared.operator.symbol())
        }
        ConditionNode::Null => "null".into(),
        ConditionNode::After(after) => {
            let cause = after.cause.as_ref().map(|cause| format!(" {}", condition(cause))).unwrap_or_default();
            format!("(after {}{cause})", after.label.node)
        }
        ConditionNode::Broken => "(could not be read)".into(),
    }
}

fn call(written: &Call<'_>) -> String {
    let words: Vec<_> = std::iter::once(written.name.to_owned()).chain(written.args.iter().map(arg)).collect();
    words.join(" ")
}

fn arg(written: &Arg<'_>) -> String {
    match written {
        Arg::Number(value) => number(value),
        Arg::Infinity(_) => "inf".into(),
        Arg::String(text) => format!("{:?}", text.node),
        Arg::Name(name) => name.node.to_owned(),
        Arg::Module(name) => format!("{} module", name.node),
    }
}

fn number(written: &Number<'_>) -> String {
    format!("{}{}", written.digits(), written.unit().unwrap_or_default())
}

fn count(written: &Count<'_>) -> String {
    match written {
        Count::Number(value) => number(value),
        Count::Infinity(_) => "inf".into(),
        Count::Name(name) => name.node.to_owned(),
    }
}
