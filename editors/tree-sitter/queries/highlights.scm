; Comments

(comment) @comment
(block_comment) @comment
(doc_comment) @comment.documentation

; Words

["use" "FRAME" "here" "module"] @keyword
["Atom"] @keyword
["Group"] @keyword
["ExecPlan"] @keyword.repeat
["OR" "or" "AND" "and" "NOT" "not" "RISING" "rising" "after"] @keyword.operator
(null) @constant.builtin
(infinity) @constant.builtin
(sigma_null) @keyword

; Literals

(number) @number
(unit) @number
(text) @string

; Names

(plan name: (name) @type)
(parameter name: (name) @variable.parameter)
(type) @type.builtin
(plan_label) @label
(label name: (name) @label)
(after label: (name) @label)
(module name: (name) @variable)
(robot) @variable
(owner) @variable
(argument) @variable.parameter
(element (reference name: (name) @type))
(loop (reference name: (name) @type))
(atom (reference name: (name) @function))
(atom (call name: (name) @function))
(formal body: (call name: (name) @function))
(condition (reference name: (name) @function.builtin))
(condition (call name: (name) @function.builtin))
(or (reference name: (name) @function.builtin))
(or (call name: (name) @function.builtin))
(and (reference name: (name) @function.builtin))
(and (call name: (name) @function.builtin))
(not (reference name: (name) @function.builtin))
(not (call name: (name) @function.builtin))
(rising (reference name: (name) @function.builtin))
(rising (call name: (name) @function.builtin))
(after cause: (reference name: (name) @function.builtin))
(after cause: (call name: (name) @function.builtin))
(formal condition: (reference name: (name) @function.builtin))
(formal condition: (call name: (name) @function.builtin))
(comparison left: (reference name: (name) @property))
(comparison left: (call name: (name) @property))
(comparison right: (reference name: (name) @property))
(comparison right: (call name: (name) @property))
(formal time: (name) @variable.parameter)
(element count: (name) @variable.parameter)
(loop count: (name) @variable.parameter)

; Signs

["==" "<" "<=" "≤" "\\leq" ">" ">=" "≥" "\\geq" "^" "="] @operator
["," ":"] @punctuation.delimiter
["(" ")" "{" "}" "\\{" "\\}" "[" "]"] @punctuation.bracket
