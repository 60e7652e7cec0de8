; A plan is known in the whole file, its parameters and labels inside it.

(file) @local.scope
(plan) @local.scope

(plan name: (name) @local.definition.type)
(parameter name: (name) @local.definition.parameter)
(label name: (name) @local.definition)

(element (reference name: (name) @local.reference))
(loop (reference name: (name) @local.reference))
(after label: (name) @local.reference)
(argument) @local.reference
(element count: (name) @local.reference)
(loop count: (name) @local.reference)
(formal time: (name) @local.reference)
