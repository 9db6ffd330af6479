// `ragtop serve` as a child process.
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import path from 'node:path';
import { pageFile, programFile } from './acceptance.mjs';

const START = 120;  // s, after which a program that does not answer is given up

export class Program {
  #child;
  #output = '';
  port = 0;

  /**
   * @param {{defer: function, folder: string}} test
   * @param {string} scene name or file
   * @param {string[]} options more of `ragtop serve`
   */
  static async start({ defer, folder }, scene, options = []) {
    const program = new Program();
    // Without the page, the program serves a few words in its place.
    const page = existsSync(pageFile) ? ['--page', pageFile] : [];
    await program.#start(scene, ['--port', '0', ...page, '--tuning', path.join(folder, 'tuning'), ...options]);
    defer(() => program.stop());
    return program;
  }

  get url() {
    return `http://127.0.0.1:${this.port}/`;
  }

  get pid() {
    return this.#child.pid;
  }

  get running() {
    return this.#child.exitCode === null && this.#child.signalCode === null;
  }

  /** What it has printed so far. */
  get output() {
    return this.#output;
  }

  /** Asks it to end; throws when it does not end well. */
  async stop() {
    if (this.running) {
      const ended = new Promise((resolve) => this.#child.once('exit', resolve));
      this.#child.kill('SIGINT');
      const timer = setTimeout(() => this.#child.kill('SIGKILL'), 20000);
      await ended;
      clearTimeout(timer);
    }
    if (this.#child.exitCode !== 0) {
      throw new Error(`the program ended with ${this.#child.exitCode ?? this.#child.signalCode}:\n${this.#output}`);
    }
  }

  #start(scene, options) {
    this.#child = spawn(programFile, ['serve', scene, ...options], { stdio: ['ignore', 'pipe', 'pipe'] });
    return new Promise((resolve, reject) => {
      const give = () => reject(new Error(`no address printed after ${START} s:\n${this.#output}`));
      const timer = setTimeout(give, 1000 * START);
      const take = (chunk) => {
        this.#output += chunk;
        const address = /http:\/\/127\.0\.0\.1:(\d+)/.exec(this.#output);
        if (!address || this.port !== 0) return;
        clearTimeout(timer);
        this.port = Number(address[1]);
        resolve();
      };
      this.#child.stdout.on('data', take);
      this.#child.stderr.on('data', take);
      this.#child.once('exit', (code) => reject(new Error(`the program ended with ${code}:\n${this.#output}`)));
    });
  }
}
