// An adapter for your code in JavaScript. Fill in the five places, then: mpmstab spectrum -program 'node mine.js'
// mpmstab chooses the particles: 10 cells each way with 2 particles each way, or those of -program_scene.
// Standard output is for mpmstab: what your code prints with console.log goes to standard error.
const fs = require('fs');
console.log = console.error;

// FILL 1: one particle at rest: the names and values of all that a step changes and a later step reads, and what else differs
// from particle to particle. For each name a list of numbers.
const rest = { x: [0, 0], v: [0, 0], stress: [0, 0, 0], volume: [1], mass: [1] };

// FILL 2: the number of directions, and the width of a cell. mpmstab adds periodic: the period of each direction, or null.
const grid = { dim: 2, cell_width: 0.1 };

// FILL 3: the parameters that mpmstab may set, with the values of your code.
const parameters = { dt: 1e-4 };

// FILL 4: which of the names above is the place, and which are the volume and the mass (null where they are not there).
const roles = { place: 'x', volume: 'volume', mass: 'mass' };

// FILL 5: one step. It changes the state, which has for each name a list of numbers for each particle, and keeps nothing else.
function step(state, parameters, grid) { throw new Error('FILL 5: one step of your code'); }

// Below is the protocol: a line of JSON, and after it doubles, particle by particle.
const names = Object.keys(rest);
const numbers = names.reduce((sum, name) => sum + rest[name].length, 0);
let particles = 0;

function pack(of) {
  const all = new Float64Array(numbers * of[names[0]].length);
  let n = 0;
  for (const p in of[names[0]]) for (const name of names) for (const value of of[name][p]) all[n++] = value;
  return Buffer.from(all.buffer);
}

function unpack(bytes, at, count) {
  const all = new Float64Array(bytes.buffer, bytes.byteOffset + 8 * at * numbers * count, numbers * count);
  const of = Object.fromEntries(names.map((name) => [name, []]));
  let n = 0;
  for (let p = 0; p < count; p++) for (const name of names) of[name].push(Array.from(all.subarray(n, n += rest[name].length)));
  return of;
}

// The state of particles with these places, volumes and masses.
function arrange(bytes) {
  const all = new Float64Array(bytes.buffer), of = Object.fromEntries(names.map((name) => [name, []]));
  for (let n = 0; n < all.length; n += grid.dim + 2) {
    for (const name of names) of[name].push([...rest[name]]);
    const put = (role, values) => { if (roles[role]) of[roles[role]][of[roles[role]].length - 1] = values; };
    put('place', Array.from(all.subarray(n, n + grid.dim)));
    put('volume', [all[n + grid.dim]]);
    put('mass', [all[n + grid.dim + 1]]);
  }
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

for (let line = readLine(); line !== null; line = readLine()) {
  const message = JSON.parse(line);
  let head = {}, tail = Buffer.alloc(0);
  if (message.do === 'quit') break;
  const states = message.states || 1, count = message.particles || particles; // states one after another
  const given = message.do === 'step' ? read(8 * numbers * count * states) : message.do === 'scene' ? read(8 * (grid.dim + 2) * count) : null;
  try {
    if (message.do === 'describe') {
      head = { protocol: 1, name: 'mine', ...grid, scenes: true, parameters, batch: 64,
               fields: names.map((name) => ({ name, size: rest[name].length, place: name === roles.place })) };
    } else if (message.do === 'scene') {
      [particles, grid.periodic] = [count, message.periodic];
      tail = pack(arrange(given));
    } else if (message.do === 'set') {
      for (const name of Object.keys(parameters)) if (name in message) parameters[name] = message[name];
    } else {
      for (let at = 0; at < states; at++) {
        const now = unpack(given, at, count);
        for (let n = 0; n < message.steps; n++) step(now, parameters, grid);
        tail = Buffer.concat([tail, pack(now)]);
      }
    }
  } catch (wrong) {
    [head, tail] = [{ error: String(wrong.message) }, Buffer.alloc(0)];
  }
  write(Buffer.from(JSON.stringify(head) + '\n'));
  write(tail);
}
