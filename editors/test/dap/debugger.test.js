// The debugger as VS Code's makers test theirs: through the real binary, with their client.

'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const path = require('node:path');
const { test } = require('node:test');
const { DebugClient } = require('@vscode/debugadapter-testsupport');

const folder = process.env.MDLE_TEST_FOLDER;
const program = path.join(folder, 'plan.mdle');

const PLAN = `{ Patrol (wait 2000s)
  ExecPlan inf {
    out: (Atom (RISING bumper OR wait 3s) (go 20 0))
    { Back (atIsection 1000)
      (Atom (bumper AND wait 1s) (go -10 0))^3
      (Atom (NOT after out wait 3s OR wait 2s) stop)
    }
  }
}
`;

/** A script in which interrupts fire by chance, but always the same. */
function script(turns) {
  let state = 1;
  const chance = () => (state = (state * 48271) % 2147483647) / 2147483647;
  const line = (turn) => {
    const fired = ['bumper', 'atIsection 1000'].filter((_, rare) => chance() < (rare ? 0.03 : 0.4));
    return JSON.stringify({ t: turn / 2, fired });
  };
  return Array.from({ length: turns }, (_, turn) => line(turn)).join('\n') + '\n';
}

/** Runs a test with a client whose plan is launched and stopped at its entry. */
function session(name, turns, run) {
  test(name, { timeout: 120_000 }, async () => {
    fs.mkdirSync(folder, { recursive: true });
    fs.writeFileSync(program, PLAN);
    const lines = path.join(folder, `${turns}.jsonl`);
    fs.writeFileSync(lines, script(turns));
    const client = new DebugClient(process.env.MDLEC, 'dap', 'mdle');
    await client.start();
    try {
      await Promise.all([
        client.waitForEvent('initialized').then(() => client.configurationDoneRequest()),
        client.launch({ program, script: lines, target: 'sim', stopOnEntry: true }),
        client.waitForEvent('stopped'),
      ]);
      await run(client);
    } finally {
      await client.stop();
    }
  });
}

/** Makes a motion, and waits until the run has stopped again. */
async function move(client, command, args = {}) {
  const [stopped] = await Promise.all([client.waitForEvent('stopped'), client.customRequest(command, { threadId: 1, ...args })]);
  return stopped.body.reason;
}

/** All that a run shows: the stack, and the variables of each of its frames. */
async function state(client) {
  const { stackFrames } = (await client.stackTraceRequest({ threadId: 1 })).body;
  const shown = [];
  for (const frame of stackFrames) {
    shown.push(`${frame.name} ${frame.line}:${frame.column}`);
    const { scopes } = (await client.scopesRequest({ frameId: frame.id })).body;
    for (const { name, variablesReference } of scopes) shown.push(name, await variables(client, variablesReference));
  }
  return shown;
}

async function variables(client, variablesReference) {
  const list = (await client.variablesRequest({ variablesReference })).body.variables;
  const below = (variable) => (variable.variablesReference ? variables(client, variable.variablesReference) : []);
  return Promise.all(list.map(async (variable) => [variable.name, variable.value, await below(variable)]));
}

session('stepping back and forth over 1,000 turns ends in the same state', 1_001, async (client) => {
  const start = await state(client);
  for (let turn = 0; turn <= 1_000; turn++) await move(client, 'next');
  const end = await state(client);
  for (let turn = 0; turn <= 1_000; turn++) await move(client, 'stepBack');
  assert.deepStrictEqual(await state(client), start);
  for (let turn = 0; turn <= 1_000; turn++) await move(client, 'next');
  assert.deepStrictEqual(await state(client), end);
  assert.match(JSON.stringify(end), /"t","500 s"/);
});

session('breakpoints stop at lines, at operands and at times', 200, async (client) => {
  const operand = PLAN.split('\n')[4].indexOf('wait 1s') + 1;
  const source = { path: program };
  const set = await client.setBreakpointsRequest({ source, breakpoints: [{ line: 6 }, { line: 5, column: operand }] });
  assert.deepStrictEqual(set.body.breakpoints.map(({ verified, line }) => [verified, line]), [[true, 6], [true, 5]]);
  const names = await client.setFunctionBreakpointsRequest({ breakpoints: [{ name: '50s' }] });
  assert.ok(names.body.breakpoints[0].verified);
  const stops = new Set();
  for (let reason = 'breakpoint'; reason === 'breakpoint'; ) {
    reason = await move(client, 'continue');
    const [frame] = (await client.stackTraceRequest({ threadId: 1 })).body.stackFrames;
    if (reason === 'breakpoint') stops.add(frame.line);
  }
  assert.ok(stops.has(6) && stops.has(5), [...stops].join());
});

session('a condition says why it does not fire', 200, async (client) => {
  await client.setBreakpointsRequest({ source: { path: program }, breakpoints: [{ line: 6 }] });
  await move(client, 'continue');
  const { result } = (await client.evaluateRequest({ expression: 'NOT after out wait 3s OR wait 2s', context: 'hover', frameId: 1 })).body;
  assert.match(result, /^holds; `after out wait 3` does not hold; `wait 2` does not hold: 0 s of 2 s have passed$/);
  assert.strictEqual(await move(client, 'stepOut'), 'step');
  assert.strictEqual(await move(client, 'reverseContinue'), 'breakpoint');
});
