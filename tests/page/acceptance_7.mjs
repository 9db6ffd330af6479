// ./check runs these tests, and ./run needs no node: both scripts run here beside tools that only write down what they
// are asked for.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { chmod, cp, mkdir, readFile, symlink, writeFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import path from 'node:path';
import { acceptance, root, say } from './support/acceptance.mjs';

/** What a shell script may take for granted on any Debian. */
const TOOLS = [
  'awk', 'bash', 'cat', 'chmod', 'dirname', 'env', 'find', 'head', 'id', 'ls', 'mkdir', 'mktemp', 'mv', 'rm', 'sed', 'sh', 'touch',
];

const CMAKE = `
if [ "$1" = --build ]; then
  printf '#!/bin/sh\\necho ragtop "$@" >>"$CALLS"\\n' >build/release/ragtop
  chmod +x build/release/ragtop
fi
mkdir -p build/release
touch build/release/build.ninja`;
const NPM = `
case "$*" in
*build*)
  mkdir -p build/page
  touch build/page/ragtop.html ;;
esac`;

/** A copy of the source tree's scripts, and tools that write their calls into a file. */
class Sandbox {
  static async make(folder, tools) {
    const box = new Sandbox();
    box.tree = path.join(folder, 'tree');
    box.bin = path.join(folder, 'bin');
    box.calls = path.join(folder, 'calls');
    await mkdir(path.join(box.tree, 'page'), { recursive: true });
    await mkdir(box.bin);
    await writeFile(box.calls, '');
    for (const name of ['run', 'check', 'packages.txt', 'scripts', 'page/package-lock.json']) {
      await cp(path.join(root, name), path.join(box.tree, name), { recursive: true });
    }
    for (const name of TOOLS) {
      const found = ['/usr/bin', '/bin'].map((place) => path.join(place, name)).find(existsSync);
      if (found) await symlink(found, path.join(box.bin, name));
    }
    // All that packages.txt asks for is there.
    await box.#tool('dpkg-query', 'for name; do case $name in -*) ;; *) echo "$name installed" ;; esac; done', false);
    for (const [name, script] of Object.entries(tools)) await box.#tool(name, script);
    return box;
  }

  /** Runs a script of the tree; what it has printed and which tools it has called. */
  async run(script, ...args) {
    const env = { PATH: this.bin, CALLS: this.calls, HOME: this.tree };
    const options = { env, encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] };
    const output = execFileSync(path.join(this.tree, script), args, options);
    const calls = (await readFile(this.calls, 'utf8')).trim().split('\n');
    return { output, calls };
  }

  async #tool(name, script, noted = true) {
    const file = path.join(this.bin, name);
    await writeFile(file, `#!/bin/sh\n${noted ? `echo ${name} "$@" >>"$CALLS"` : ''}\n${script}\n`);
    await chmod(file, 0o755);
  }
}

await acceptance([], async ({ folder }) => {
  say('./run, where there is no node');
  const user = await Sandbox.make(path.join(folder, 'user'), { cmake: CMAKE });
  const { output, calls } = await user.run('run');
  assert.ok(calls.some((call) => call.startsWith('ragtop run crash --out out/crash')), calls.join('\n'));
  assert.ok(!calls.some((call) => /\b(node|npm)\b/.test(call)), calls.join('\n'));
  assert.ok(output.trim().split('\n').at(-1).includes('./run --page'), 'it does not tell how to see the scene');

  say('./run --page builds the page and serves the scene that is named');
  const tools = { cmake: CMAKE, npm: NPM, node: 'echo 18' };
  const viewer = await Sandbox.make(path.join(folder, 'viewer'), tools);
  const served = (await viewer.run('run', '--page', 'track', '--', '--port', '0')).calls;
  assert.ok(served.some((call) => call.startsWith('npm --prefix page ci')), served.join('\n'));
  assert.equal(served.at(-1), 'ragtop serve track --page build/page/ragtop.html --port 0');

  say('./check installs the browser, builds the page before the tests, and leaves none of them out');
  const developer = await Sandbox.make(path.join(folder, 'developer'), { ...tools, ctest: '' });
  const checked = (await developer.run('check')).calls;
  const place = (pattern) => checked.findIndex((call) => pattern.test(call));
  assert.ok(place(/^npm .*run .*build/) >= 0 && place(/^npm .*run .*build/) < place(/^ctest/), checked.join('\n'));
  assert.equal(checked.filter((call) => call.startsWith('ctest')).join('\n'), 'ctest --preset release');
  const packages = await readFile(path.join(root, 'packages.txt'), 'utf8');
  assert.ok(/^check: chromium$/m.test(packages));
  const presets = JSON.parse(await readFile(path.join(root, 'CMakePresets.json'), 'utf8'));
  for (const { filter } of presets.testPresets) assert.ok(!/page/.test(JSON.stringify(filter ?? {})));

  say('node and npm are installed on their own, each only where it is absent');
  assert.ok(/^node: nodejs$/m.test(packages) && /^npm: npm$/m.test(packages));
  assert.ok(!/^(run|check|matrix): (nodejs|npm)$/m.test(packages));
});
