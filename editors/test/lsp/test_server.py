"""Each feature of the language server once, through the real binary, with a client that knows nothing of it: pytest-lsp."""

import os
from pathlib import Path

import pytest
import pytest_lsp
from lsprotocol import types
from pytest_lsp import ClientServerConfig, LanguageClient, client_capabilities

LEG = """/// Ahead for a while.
{ Leg(v: speed) (bumper)
  ahead: (Atom (wait 5s OR atIsection 1000) (go v 0))
  (Atom (NOT after ahead wait 5s OR wait 2s) stop)
}
"""
MAIN = """use "leg.mdle"

{ Main (wait 1min)
  Leg(20cm/s)
  (Atom (null) turn 90)
}
"""


class Project:
    """Two plans in a folder, open in the client."""

    def __init__(self, client, folder):
        self.client, self.folder, self.versions = client, folder, {}

    def uri(self, name):
        return (self.folder / name).as_uri()

    def document(self, name):
        return types.TextDocumentIdentifier(uri=self.uri(name))

    def open(self, name, text):
        (self.folder / name).write_text(text)
        self.versions[name] = 1
        item = types.TextDocumentItem(uri=self.uri(name), language_id="mdle", version=1, text=text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(text_document=item))

    def change(self, name, text):
        self.versions[name] += 1
        identifier = types.VersionedTextDocumentIdentifier(uri=self.uri(name), version=self.versions[name])
        whole = types.TextDocumentContentChangeWholeDocument(text=text)
        self.client.text_document_did_change(
            types.DidChangeTextDocumentParams(text_document=identifier, content_changes=[whole])
        )

    async def errors(self, name):
        """The diagnostics of a document, once there are any."""
        while not self.client.diagnostics.get(self.uri(name)):
            await self.client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        return self.client.diagnostics[self.uri(name)]

    def at(self, name, text, part, offset=0):
        """The position of a part of a text, as parameters of a request."""
        before = text[: text.index(part) + offset]
        position = types.Position(line=before.count("\n"), character=len(before.rsplit("\n", 1)[-1]))
        return {"text_document": self.document(name), "position": position}


@pytest_lsp.fixture(config=ClientServerConfig(server_command=[os.environ["MDLEC"], "lsp"]))
async def client(lsp_client: LanguageClient):
    await lsp_client.initialize_session(
        types.InitializeParams(
            capabilities=client_capabilities("visual-studio-code"),
            initialization_options={"target": "sim", "book": "https://book.example"},
        )
    )
    yield
    await lsp_client.shutdown_session()


@pytest.fixture
def project(client, tmp_path):
    project = Project(client, tmp_path)
    project.open("leg.mdle", LEG)
    project.open("main.mdle", MAIN)
    return project


async def test_diagnostics_come_as_one_types_with_a_quick_fix(project):
    project.change("main.mdle", MAIN.replace("turn", "trun"))
    [found] = await project.errors("main.mdle")
    assert (found.code, found.severity) == ("E0201", types.DiagnosticSeverity.Error)
    assert found.code_description.href == "https://book.example/messages.html#e0201"
    context = types.CodeActionContext(diagnostics=[found])
    params = types.CodeActionParams(text_document=project.document("main.mdle"), range=found.range, context=context)
    [action] = await project.client.text_document_code_action_async(params)
    [edits] = (action.edit.changes or {}).values() or [action.edit.document_changes[0].edits]
    assert edits[0].new_text == "turn"


async def test_hover_signature_help_and_completion(project):
    hover = await project.client.text_document_hover_async(types.HoverParams(**project.at("leg.mdle", LEG, "go v")))
    assert "speed" in hover.contents.value
    params = types.SignatureHelpParams(**project.at("leg.mdle", LEG, "go v", 4))
    help = await project.client.text_document_signature_help_async(params)
    assert help.signatures[0].label.startswith("go")
    params = types.CompletionParams(**project.at("leg.mdle", LEG, "atIsection", 3))
    answer = await project.client.text_document_completion_async(params)
    items = answer.items if isinstance(answer, types.CompletionList) else answer
    labels = [item.label for item in items]
    assert "atIsection" in labels and "go" not in labels


async def test_definition_references_and_rename_reach_other_files(project):
    place = project.at("main.mdle", MAIN, "Leg(20")
    found = await project.client.text_document_definition_async(types.DefinitionParams(**place))
    found = found[0] if isinstance(found, list) else found
    assert (found.uri, found.range.start.line) == (project.uri("leg.mdle"), 1)
    context = types.ReferenceContext(include_declaration=True)
    found = await project.client.text_document_references_async(types.ReferenceParams(context=context, **place))
    assert {location.uri for location in found} == {project.uri("main.mdle"), project.uri("leg.mdle")}
    prepared = await project.client.text_document_prepare_rename_async(types.PrepareRenameParams(**place))
    assert prepared is not None
    edit = await project.client.text_document_rename_async(types.RenameParams(new_name="Stretch", **place))
    changed = edit.changes or {change.text_document.uri: change.edits for change in edit.document_changes}
    assert {uri: [one.new_text for one in edits] for uri, edits in changed.items()} == {
        project.uri("main.mdle"): ["Stretch"],
        project.uri("leg.mdle"): ["Stretch"],
    }
    with pytest.raises(Exception):
        await project.client.text_document_rename_async(types.RenameParams(new_name="Main", **place))


async def test_formatting_of_a_document_and_of_a_range(project):
    text = "{ A (wait 5)\n(Atom (bumper)   stop) }\n\n{ B   (wait 5) (Atom (bumper) stop) }\n"
    project.open("loose.mdle", text)
    options = types.FormattingOptions(tab_size=2, insert_spaces=True)
    params = types.DocumentFormattingParams(text_document=project.document("loose.mdle"), options=options)
    edits = await project.client.text_document_formatting_async(params)
    assert edits and max(edit.range.end.line for edit in edits) == 3
    first = types.Range(start=types.Position(line=0, character=0), end=types.Position(line=1, character=5))
    params = types.DocumentRangeFormattingParams(
        text_document=project.document("loose.mdle"), range=first, options=options
    )
    edits = await project.client.text_document_range_formatting_async(params)
    assert edits and all(edit.range.end.line < 3 for edit in edits)


async def test_symbols_folds_selections_and_colours(project):
    document = project.document("leg.mdle")
    symbols = await project.client.text_document_document_symbol_async(types.DocumentSymbolParams(text_document=document))
    assert [symbol.name for symbol in symbols] == ["Leg"]
    folds = await project.client.text_document_folding_range_async(types.FoldingRangeParams(text_document=document))
    assert any((fold.start_line, fold.end_line) in [(1, 4), (1, 3)] for fold in folds)
    positions = [project.at("leg.mdle", LEG, "atIsection")["position"]]
    params = types.SelectionRangeParams(text_document=document, positions=positions)
    [selection] = await project.client.text_document_selection_range_async(params)
    assert selection.parent is not None
    tokens = await project.client.text_document_semantic_tokens_full_async(
        types.SemanticTokensParams(text_document=document)
    )
    assert len(tokens.data) > 50 and len(tokens.data) % 5 == 0
    params = types.DocumentHighlightParams(**project.at("leg.mdle", LEG, "ahead"))
    assert len(await project.client.text_document_document_highlight_async(params)) == 2


async def test_hints_lenses_and_their_commands(project):
    whole = types.Range(start=types.Position(line=0, character=0), end=types.Position(line=9, character=0))
    params = types.InlayHintParams(text_document=project.document("main.mdle"), range=whole)
    hints = await project.client.text_document_inlay_hint_async(params)
    assert hints
    params = types.CodeLensParams(text_document=project.document("main.mdle"))
    lenses = await project.client.text_document_code_lens_async(params)
    commands = {lens.command.command: lens.command.arguments for lens in lenses}
    assert set(commands) == {"mdle.run", "mdle.draw"}
    run = types.ExecuteCommandParams(command="mdle.run", arguments=commands["mdle.run"])
    words = await project.client.workspace_execute_command_async(run)
    assert words[:2] == ["mdlec", "run"] and words[-1] == "Main"
    draw = types.ExecuteCommandParams(command="mdle.draw", arguments=commands["mdle.draw"])
    drawn = await project.client.workspace_execute_command_async(draw)
    svg = drawn["svg"] if isinstance(drawn, dict) else drawn.svg
    assert svg.startswith("<svg")
