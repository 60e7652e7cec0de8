/**
 * @file Grammar of MDLe, for editors: docs/src/grammar.md, with the notation of the paper (docs/src/reference/language.md, 3.2).
 * @license MIT OR Apache-2.0
 */

/// <reference types="tree-sitter-cli/dsl" />
// @ts-check

const DECIMAL = /[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?/;
const UNIT = /m|cm|mm|in|ft|m\/s|cm\/s|mm\/s|in\/s|rad|deg|rad\/s|deg\/s|s|ms|min|h|V|Hz/;
// What touches a number belongs to it: `20cms` is no number, and no number with a name after it.
const TOUCHING = /[+-]?[0-9]+([\p{L}\p{N}_.°]|\/\p{L}|[+-][0-9])+/;
const LABEL_PART = String.raw`([\p{L}\p{M}\p{Nd}_]+|\{\s*(\\text\{)?[\s\p{L}\p{M}\p{Nd}_]+\}?\s*\})`;
const LABEL = new RegExp(String.raw`(Γ|\\?Gamma)_${LABEL_PART}(\^${LABEL_PART})?`);

/** A list with commas between its elements. */
const list = (rule) => seq(rule, repeat(seq(',', rule)));

/** A parenthesis that touches the name before it. */
const touching = ($) => alias($._touching, '(');

/** The forms in parentheses that begin with `open`. */
const atom = ($, open) => seq(open, 'Atom', field('condition', $.condition), field('law', $._law), ')');
const string = ($, open) => seq(open, optional($._string), ')');
const formal = ($, open) =>
  seq(
    open,
    field('body', choice(optional($._string), alias($._literal_call, $.call))),
    ',',
    field('condition', $._or),
    optional(seq(',', field('time', choice($.number, $.infinity, $.name)))),
    ')',
  );

module.exports = grammar({
  name: 'mdle',

  extras: ($) => [
    /[\s;$\u{feff}]/,
    $._line_break,
    $.doc_comment,
    $.comment,
    $.block_comment,
    $._text_open,
    $._text_close,
  ],

  // The scanner finds a parenthesis that touches a name, the braces of `\text{…}`, and `\sigma_{null}`.
  externals: ($) => [$._touching, $._text_open, $._text_close, $._typeset_sigma_null],

  word: ($) => $.name,

  reserved: {
    global: () => [
      'use', 'Atom', 'ExecPlan', 'OR', 'or', 'AND', 'and', 'NOT', 'not', 'RISING', 'rising', 'null', 'module', 'after',
      'FRAME', 'sigma_null', 'σ_null', 'inf', 'infinity',
    ],
  },

  supertypes: ($) => [$._primary],

  inline: ($) => [$._open, $._close],

  conflicts: ($) => [
    [$._string],
    [$._reference, $._call_of],
    [$._primary, $._call],
    [$._primary, $._quark],
    [$.parameter, $.label],
    [$._literal_call, $._argument],
  ],

  rules: {
    file: ($) => repeat(choice($.use, $.plan, $.printed_plan)),

    use: ($) => seq('use', field('file', $.text)),

    // ---- Plans ----

    plan: ($) =>
      seq(
        optional(seq($.plan_label, '=')),
        $._open,
        optional($.group),
        // `Group` is a name where no bracket follows it.
        field('name', choice($.name, alias('Group', $.name))),
        optional(field('parameters', $.parameters)),
        choice(
          seq(field('condition', alias($._head_condition, $.condition)), optional($._elements)),
          optional($._elements),
          seq(alias($._touching_element, $.element), repeat($._next_element)),
        ),
        optional($.sigma_null),
        $._close,
      ),

    // The robots of the plan of a group.
    group: ($) => seq('Group', '[', optional(seq($._robot, repeat(seq(optional(','), $._robot)))), ']'),

    _robot: ($) => alias($.name, $.robot),

    // A plan as the paper prints it, without braces.
    printed_plan: ($) =>
      seq(
        optional(seq($.plan_label, '=')),
        alias($._printed_element, $.element),
        repeat(seq(optional(','), alias($._printed_element, $.element))),
        $.sigma_null,
      ),

    _printed_element: ($) =>
      seq(choice($.atom, $.string, $.formal), optional(seq('^', field('count', choice($.number, $.infinity))))),

    parameters: ($) => prec.dynamic(2, seq(choice('(', touching($)), list($.parameter), ')')),

    parameter: ($) => seq(field('name', $.name), ':', field('type', $.type)),

    type: ($) => seq(choice($.name, 'module'), optional(seq('[', $.number, ']'))),

    _head_condition: ($) => prec.dynamic(1, seq(choice('(', touching($)), $._or, ')')),

    // ---- Elements ----

    _elements: ($) => seq($.element, repeat($._next_element)),

    _next_element: ($) => seq(optional(','), $.element),

    element: ($) => seq(optional($.label), optional($.frame), $._primary, optional($._power)),

    // In parentheses, a comma and a name are formal notation.
    _string: ($) =>
      seq($.element, repeat(choice($.element, seq(',', alias($._element_after_comma, $.element))))),

    _element_after_comma: ($) =>
      choice(
        seq($.label, optional($.frame), $._primary, optional($._power)),
        seq($.frame, $._primary, optional($._power)),
        seq(choice($.atom, $.string, $.formal, $.plan, $.loop), optional($._power)),
      ),

    _touching_element: ($) =>
      seq(
        choice(
          alias($._touching_atom, $.atom),
          alias($._touching_string, $.string),
          alias($._touching_formal, $.formal),
        ),
        optional($._power),
      ),

    label: ($) => seq(field('name', $.name), ':'),

    frame: ($) => seq('FRAME', choice($.number, 'here')),

    _power: ($) => seq('^', field('count', $._count)),

    _count: ($) => choice($.number, $.infinity, $.name),

    _primary: ($) => choice($.atom, $.plan, $.reference, $.loop, $.string, $.formal),

    atom: ($) => atom($, '('),
    string: ($) => string($, '('),
    formal: ($) => prec.dynamic(1, formal($, '(')),
    _touching_atom: ($) => atom($, touching($)),
    _touching_string: ($) => string($, touching($)),
    _touching_formal: ($) => prec.dynamic(1, formal($, touching($))),

    loop: ($) =>
      seq('ExecPlan', field('count', $._count), choice(seq($._open, optional($._elements), $._close), $.reference)),

    // ---- Conditions ----

    condition: ($) => seq('(', $._or, ')'),

    _or: ($) => choice($._and, alias($._or_of, $.or)),
    _or_of: ($) => seq($._and, repeat1(seq(choice('OR', 'or'), $._and))),
    _and: ($) => choice($._not, alias($._and_of, $.and)),
    _and_of: ($) => seq($._not, repeat1(seq(choice('AND', 'and'), $._not))),
    _not: ($) => choice($._test, $.not, $.rising),
    not: ($) => seq(choice('NOT', 'not'), $._test),
    rising: ($) => seq(choice('RISING', 'rising'), $._test),

    _test: ($) => choice($.condition, $._quark, $.comparison, $.null, $.after),

    null: () => 'null',

    after: ($) => seq('after', field('label', $.name), optional(field('cause', choice($.condition, $._call)))),

    comparison: ($) =>
      seq(
        field('left', $._quark),
        field('operator', choice('==', '<', '<=', '≤', '\\leq', '>', '>=', '≥', '\\geq')),
        field('right', choice($._quark, $.number, $.infinity)),
      ),

    // ---- Calls ----

    _law: ($) => choice($._call, seq('(', $._call, ')')),

    _call: ($) => choice($.reference, $.call),

    // In a condition of a group, the name of a robot and a dot come first.
    _quark: ($) => choice($.reference, $.call, alias($._owned_reference, $.reference), alias($._owned_call, $.call)),
    _owned_reference: ($) => seq($.owner, $._reference),
    _owned_call: ($) => seq($.owner, $._call_of),
    owner: () => token(prec(1, /[\p{L}_][\p{L}\p{M}\p{Nd}_]*\./)),

    // A name, perhaps with arguments in parentheses that touch it.
    reference: ($) => $._reference,
    _reference: ($) =>
      seq(field('name', $.name), optional(seq(touching($), optional(seq($._argument, repeat(seq(optional(','), $._argument)))), ')'))),

    call: ($) => $._call_of,
    _call_of: ($) => seq(field('name', $.name), repeat1($._argument)),

    _literal_call: ($) =>
      seq(field('name', $.name), choice($._number, $.infinity, $.text), repeat($._argument)),

    _argument: ($) =>
      choice(
        $._number,
        $.infinity,
        $.text,
        alias($.name, $.argument),
        $.module,
        seq('(', $._argument, repeat(seq(optional(','), $._argument)), ')'),
      ),

    module: ($) => seq(field('name', $.name), 'module'),

    // Only units have a `/`, so a space may be before them.
    _number: ($) => seq($.number, optional($.unit)),

    // ---- Tokens ----

    number: ($) => choice($._good_number, seq($._bad_number, $._never)),
    _good_number: () => token(seq(DECIMAL, optional(UNIT))),
    _bad_number: () => token(TOUCHING),
    // No text has it after a number: NUL.
    _never: () => token.immediate('\0'),

    unit: () => token(/(m|cm|mm|in|rad|deg)\/s/),
    infinity: () => choice('inf', 'infinity', '∞', '\\infty'),
    text: () => /"[^"\n]*"/,
    name: () => /[\p{L}_][\p{L}\p{M}\p{Nd}_]*/,
    plan_label: () => token(prec(1, LABEL)),
    sigma_null: ($) => choice('sigma_null', 'σ_null', $._typeset_sigma_null),
    _open: () => choice('{', '\\{'),
    _close: () => choice('}', '\\}'),

    // Of typesetting.
    _line_break: () => '\\\\',
    doc_comment: () => token(prec(1, /\/\/\/([^\/\n][^\n]*)?/)),
    comment: () => token(/\/\/[^\n]*/),
    block_comment: () => token(/\/\*[^*]*\*+([^\/*][^*]*\*+)*\//),
  },
});
