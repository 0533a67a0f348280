// An adapter for your code in JavaScript. Fill in the five places, then: mpmstab spectrum -program 'node mine.js'
// Standard output is for mpmstab: what your code prints with console.log goes to standard error.
const fs = require('fs');
console.log = console.error;

// FILL 1: the state: all that a step changes and a later step reads; for each field an array of numbers for each particle.
const state = { x: [[0, 0]], v: [[0, 0]], stress: [[0, 0, 0]] };

// FILL 2: the width of a cell, and the period of each direction (null: it has no period).
const grid = { dim: 2, cell_width: 0.1, periodic: [null, null] };

// FILL 3: the parameters that mpmstab may set, with the values of your code.
const parameters = { dt: 1e-4 };

// FILL 4: the field that is the place. Where you know it, the size of a usual change of another field: { v: { scale: 20 } }.
const known = { x: { place: true } };

// FILL 5: one step. It changes the state that it is given, and keeps nothing else.
function step(state, parameters) { throw new Error('FILL 5: one step of your code'); }

// Below is the protocol: a line of JSON, and after it doubles, particle by particle.
const names = Object.keys(state);
const sizes = names.map((name) => state[name][0].length);
const numbers = sizes.reduce((a, b) => a + b, 0);
const particles = state[names[0]].length;

function pack(of) {
  const all = new Float64Array(numbers * particles);
  let n = 0;
  for (let p = 0; p < particles; p++) for (const name of names) for (const value of of[name][p]) all[n++] = value;
  return Buffer.from(all.buffer);
}

function unpack(bytes, at) {
  const all = new Float64Array(bytes.buffer, bytes.byteOffset + 8 * at * numbers * particles, numbers * particles);
  const of = Object.fromEntries(names.map((name) => [name, []]));
  let n = 0;
  for (let p = 0; p < particles; p++) names.forEach((name, f) => { of[name].push(Array.from(all.subarray(n, n += sizes[f]))); });
  return of;
}

// Reads so many bytes, or null where the input ends.
function read(count) {
  const bytes = Buffer.from(new ArrayBuffer(count));
  for (let n = 0; n < count;) {
    let more;
    try { more = fs.readSync(0, bytes, n, count - n, null); } catch (wrong) { if (wrong.code === 'EAGAIN') continue; throw wrong; }
    if (more === 0) return null;
    n += more;
  }
  return bytes;
}

function readLine() {
  const bytes = [];
  for (let byte = read(1); byte !== null; byte = read(1)) {
    if (byte[0] === 10) return Buffer.from(bytes).toString();
    bytes.push(byte[0]);
  }
  return null;
}

function write(bytes) {
  for (let n = 0; n < bytes.length;) {
    try { n += fs.writeSync(1, bytes, n); } catch (wrong) { if (wrong.code !== 'EAGAIN') throw wrong; }
  }
}

const base = pack(state);
for (let line = readLine(); line !== null; line = readLine()) {
  const message = JSON.parse(line);
  let head = {}, tail = Buffer.alloc(0);
  if (message.do === 'quit') break;
  const states = message.states || 1; // one after another
  const given = message.do === 'step' ? read(8 * numbers * particles * states) : null;
  try {
    if (message.do === 'describe') {
      head = { protocol: 1, name: 'mine', ...grid, particles, parameters, steps: 1, batch: 64,
               fields: names.map((name, f) => ({ name, size: sizes[f], ...known[name] })) };
      tail = base;
    } else if (message.do === 'set') {
      for (const name of Object.keys(parameters)) if (name in message) parameters[name] = message[name];
    } else {
      for (let at = 0; at < states; at++) {
        const now = unpack(given, at);
        for (let n = 0; n < message.steps; n++) step(now, parameters);
        tail = Buffer.concat([tail, pack(now)]);
      }
    }
  } catch (wrong) {
    [head, tail] = [{ error: String(wrong.message) }, Buffer.alloc(0)];
  }
  write(Buffer.from(JSON.stringify(head) + '\n'));
  write(tail);
}
