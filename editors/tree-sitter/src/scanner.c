// Tokens that a lexer without memory cannot find: a parenthesis that touches a name, and the braces of `\text{…}`, which
// are no part of the plan; and `\sigma_{null}`, which the generated lexer would read as the keyword.

#include "tree_sitter/parser.h"

#include <stdlib.h>

enum Token { TOUCHING, TEXT_OPEN, TEXT_CLOSE, TYPESET_SIGMA_NULL };

// True inside `\text{…}`. It contains no braces, so it is in no other.
typedef struct {
    bool is_in_text;
} Scanner;

void *tree_sitter_mdle_external_scanner_create(void) { return calloc(1, sizeof(Scanner)); }

void tree_sitter_mdle_external_scanner_destroy(void *payload) { free(payload); }

unsigned tree_sitter_mdle_external_scanner_serialize(void *payload, char *buffer) {
    buffer[0] = ((Scanner *)payload)->is_in_text;
    return 1;
}

void tree_sitter_mdle_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
    ((Scanner *)payload)->is_in_text = length == 1 && buffer[0];
}

static bool is_space(int32_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r') || c == ';' || c == '$' || c == 0xFEFF || c == 0x85 || c == 0xA0 ||
           c == 0x1680 || (c >= 0x2000 && c <= 0x200A) || c == 0x2028 || c == 0x2029 || c == 0x202F || c == 0x205F ||
           c == 0x3000;
}

static bool is_letter(int32_t c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

static bool scan_word(TSLexer *lexer, const char *word) {
    for (; *word; word++) {
        if (lexer->lookahead != *word) return false;
        lexer->advance(lexer, false);
    }
    return true;
}

static void skip_spaces(TSLexer *lexer) {
    while (is_space(lexer->lookahead) && lexer->lookahead != ';' && lexer->lookahead != '$') lexer->advance(lexer, false);
}

// Reads `text{` after a backslash, and looks for the brace that closes it, before which no other opens.
static bool scan_text(TSLexer *lexer) {
    if (!scan_word(lexer, "text") || is_letter(lexer->lookahead)) return false;
    skip_spaces(lexer);
    if (!scan_word(lexer, "{")) return false;
    lexer->mark_end(lexer);
    while (!lexer->eof(lexer) && lexer->lookahead != '}') {
        if (lexer->lookahead == '{') return false;
        if (lexer->lookahead == '\\') lexer->advance(lexer, false);
        lexer->advance(lexer, false);
    }
    return !lexer->eof(lexer);
}

// Reads `sigma_null`, `sigma_{null}` or `sigma_{\text{null}}` after a backslash.
static bool scan_sigma_null(TSLexer *lexer) {
    if (!scan_word(lexer, "sigma_")) return false;
    unsigned braces = 0;
    if (lexer->lookahead == '{') {
        lexer->advance(lexer, false);
        skip_spaces(lexer);
        braces = 1;
        if (lexer->lookahead == '\\') {
            if (!scan_word(lexer, "\\text{")) return false;
            skip_spaces(lexer);
            braces = 2;
        }
    }
    if (!scan_word(lexer, "null")) return false;
    for (; braces > 0; braces--) {
        skip_spaces(lexer);
        if (!scan_word(lexer, "}")) return false;
    }
    lexer->mark_end(lexer);
    return true;
}

bool tree_sitter_mdle_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid_symbols) {
    Scanner *scanner = payload;
    if (valid_symbols[TOUCHING] && lexer->lookahead == '(') {
        lexer->advance(lexer, false);
        lexer->mark_end(lexer);
        lexer->result_symbol = TOUCHING;
        return true;
    }
    while (is_space(lexer->lookahead)) lexer->advance(lexer, true);
    if (scanner->is_in_text && lexer->lookahead == '}') {
        lexer->advance(lexer, false);
        lexer->mark_end(lexer);
        lexer->result_symbol = TEXT_CLOSE;
        scanner->is_in_text = false;
        return true;
    }
    if (lexer->lookahead != '\\') return false;
    lexer->advance(lexer, false);
    if (lexer->lookahead == 's' && valid_symbols[TYPESET_SIGMA_NULL]) {
        lexer->result_symbol = TYPESET_SIGMA_NULL;
        return scan_sigma_null(lexer);
    }
    if (!scan_text(lexer)) return false;
    lexer->result_symbol = TEXT_OPEN;
    scanner->is_in_text = true;
    return true;
}
