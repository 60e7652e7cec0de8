// The extension: a client of `mdlec lsp` and `mdlec dap`, and three commands.

'use strict';

const path = require('node:path');
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');

/** @type {LanguageClient | undefined} */
let client;
/** The panel with the last picture. */
let panel;

const setting = (name) => vscode.workspace.getConfiguration('mdle').get(name);
const settings = () => ({ target: setting('target') || undefined, book: setting('book') || undefined });

/** Runs the words of a command line in a terminal, which shows what they print. */
function inTerminal(words) {
  const [, ...args] = words;
  const known = vscode.window.terminals.find((terminal) => terminal.name === 'MDLe' && terminal.exitStatus === undefined);
  const terminal = known ?? vscode.window.createTerminal('MDLe');
  terminal.show(true);
  // In a shell of POSIX only what is between single quotes is taken as it is.
  const quoted = [setting('mdlec'), ...args].map((word) => `'${word.replaceAll("'", "'\\''")}'`);
  terminal.sendText(quoted.join(' '));
}

/** Shows a picture beside the plan. */
function showPicture(svg, title) {
  panel ??= vscode.window.createWebviewPanel('mdle', title, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true });
  panel.onDidDispose(() => (panel = undefined));
  panel.title = title;
  const policy = `default-src 'none'; style-src 'unsafe-inline'`;
  panel.webview.html = `<!DOCTYPE html><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="${policy}">${svg}`;
}

/** Does what the answer to a command of a lens is for. */
async function executed(command, args, next) {
  const answer = await next(command, args);
  if (command === 'mdle.run') inTerminal(answer);
  if (command === 'mdle.draw') showPicture(answer.svg, args[1]);
  return answer;
}

/** The plan to run of the document in the editor: the one that a lens offers, or a choice of several. */
async function planOfEditor() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== 'mdle') return undefined;
  const lenses = (await vscode.commands.executeCommand('vscode.executeCodeLensProvider', document.uri, 1000)) ?? [];
  const names = lenses.map((lens) => lens.command).filter((command) => command?.command === 'mdle.run').map((command) => command.arguments[1]);
  if (names.length === 0) {
    vscode.window.showErrorMessage('This file has no plan to run: every plan is used by another, takes parameters, or has errors.');
    return undefined;
  }
  const name = names.length === 1 ? names[0] : await vscode.window.showQuickPick(names, { title: 'Which plan?' });
  return name && { document, uri: client.code2ProtocolConverter.asUri(document.uri), name };
}

async function runInSimulator() {
  const plan = await planOfEditor();
  if (!plan || !(await plan.document.save())) return;
  inTerminal(['mdlec', 'run', plan.document.uri.fsPath, '--plan', plan.name, '--target', 'sim', '--', '--watch']);
}

async function drawBeside() {
  const plan = await planOfEditor();
  if (plan) await vscode.commands.executeCommand('mdle.draw', plan.uri, plan.name);
}

async function traceWithScript() {
  const plan = await planOfEditor();
  if (!plan || !(await plan.document.save())) return;
  const file = plan.document.uri.fsPath;
  const folder = vscode.Uri.file(path.dirname(file));
  const chosen = await vscode.window.showOpenDialog({ title: 'Script of interrupts', defaultUri: folder, filters: { Scripts: ['jsonl'], 'All files': ['*'] } });
  if (!chosen) return;
  const target = setting('target') ? ['--target', setting('target')] : [];
  inTerminal(['mdlec', 'trace', file, '--script', chosen[0].fsPath, '--plan', plan.name, ...target]);
}

/** What a hover asks the debugger: the condition or the operand at a position. */
const evaluatable = {
  provideEvaluatableExpression(document, position) {
    // An operand is what no bracket and no word of a condition interrupts.
    const line = document.lineAt(position.line).text;
    for (const match of line.matchAll(/[^(){},]+/g)) {
      let start = match.index;
      for (const operand of match[0].split(/(\b(?:OR|or|AND|and|NOT|not|RISING|rising|Atom)\b)/)) {
        const end = start + operand.length;
        const text = operand.trim();
        if (start <= position.character && position.character < end && text !== '') {
          const first = start + operand.indexOf(text);
          return new vscode.EvaluatableExpression(new vscode.Range(position.line, first, position.line, first + text.length), text);
        }
        start = end;
      }
    }
    return undefined;
  },
};

exports.activate = async (context) => {
  const server = { command: setting('mdlec'), args: ['lsp'] };
  client = new LanguageClient('mdle', 'MDLe', server, {
    documentSelector: [{ language: 'mdle' }],
    initializationOptions: settings(),
    synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher('**/{*.mdle,mdle.toml}') },
    middleware: { executeCommand: executed },
  });
  const command = (name, run) => vscode.commands.registerCommand(name, run);
  context.subscriptions.push(
    command('mdle.runInSimulator', runInSimulator),
    command('mdle.drawBeside', drawBeside),
    command('mdle.traceWithScript', traceWithScript),
    vscode.debug.registerDebugAdapterDescriptorFactory('mdle', {
      createDebugAdapterDescriptor: () => new vscode.DebugAdapterExecutable(setting('mdlec'), ['dap']),
    }),
    vscode.languages.registerEvaluatableExpressionProvider('mdle', evaluatable),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration('mdle')) client.sendNotification('workspace/didChangeConfiguration', { settings: { mdle: settings() } });
    }),
  );
  await client.start();
};

exports.deactivate = () => client?.stop();
