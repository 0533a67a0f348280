// mls-mpm.js as a program for mpmstab: mpmstab critical -program 'node mlsmpm.js FOLDER [elastic]'
// FOLDER is a clone of https://github.com/r03ert0/mls-mpm.js. Its algebra.js and mls-mpm.js are read and run as they are, in one
// scope. mpmstab chooses the particles, which are put in the middle of the grid of 80 cells. Gravity moves all particles alike, and is
// taken off again after each step. The word elastic switches plasticity off, by their constant for it, and lets svd keep shears below
// 1e-6, which it drops otherwise.
const fs = require('fs');
const path = require('path');
console.log = console.error;

const folder = process.argv[2];
const elastic = [['const plastic = 1;', 'const plastic = 0;'], ['Math.abs(S[1]) < 1e-6', 'S[1] === 0']];
let text = ['algebra.js', 'mls-mpm.js'].map((file) => fs.readFileSync(path.join(folder, file), 'utf8')).join('\n');
for (const [theirs, ours] of process.argv.includes('elastic') ? elastic : []) {
  if (text.split(theirs).length !== 2) throw new Error(`elastic: mls-mpm.js has no '${theirs}'`);
  text = text.replace(theirs, ours);
}
const theirs = new Function(`${text}\nreturn { particles, Particle, advance, n, dx, dt, E, nu };`)();
const c = Math.sqrt(theirs.E * (1 - theirs.nu) / (1 + theirs.nu) / (1 - 2 * theirs.nu)); // of P waves
const fields = [{ name: 'x', size: 2, place: true }, { name: 'v', size: 2, scale: 0.1 * c }, { name: 'F', size: 4, scale: 0.1 },
  { name: 'C', size: 4, scale: 0.1 * c / theirs.dx }, { name: 'Jp', size: 1, scale: 0.1 }];
const numbers = 13;
let dt = theirs.dt;

const gather = (p) => [...p.x, ...p.v, ...p.F, ...p.C, p.Jp];

function step(state, steps) {
  theirs.particles.length = 0;
  for (let n = 0; n < state.length; n += numbers) {
    const q = Array.from(state.subarray(n, n + numbers));
    theirs.particles.push({ x: q.slice(0, 2), v: q.slice(2, 4), F: q.slice(4, 8), C: q.slice(8, 12), Jp: q[12], c: 0 });
  }
  for (let s = 0; s < steps; s++) {
    theirs.advance(dt);
    for (const p of theirs.particles) [p.v[1], p.x[1]] = [p.v[1] + 200 * dt, p.x[1] + 200 * dt * dt];
  }
  theirs.particles.forEach((p, i) => state.set(gather(p), i * numbers));
}

function read(bytes) {
  const all = Buffer.from(new ArrayBuffer(bytes));
  for (let n = 0; n < bytes;) {
    let more;
    try { more = fs.readSync(0, all, n, bytes - n, null); } catch (wrong) { if (wrong.code === 'EAGAIN') continue; throw wrong; }
    if (more === 0) process.exit(0);
    n += more;
  }
  return all;
}

function write(bytes) {
  for (let n = 0; n < bytes.length;) {
    try { n += fs.writeSync(1, bytes, n); } catch (wrong) { if (wrong.code !== 'EAGAIN') throw wrong; }
  }
}

let particles = 0;
for (;;) {
  let line = '', head = {}, tail = new Float64Array(0);
  for (let byte = read(1)[0]; byte !== 10; byte = read(1)[0]) line += String.fromCharCode(byte);
  const message = JSON.parse(line), count = message.particles || particles;
  if (message.do === 'quit') break;
  if (message.do === 'describe') {
    head = { protocol: 1, name: 'mls-mpm.js', dim: 2, cell_width: theirs.dx, periodic: [null, null], scenes: true, fields, parameters: { dt }, batch: 64 };
  } else if (message.do === 'scene') {
    const given = new Float64Array(read(32 * count).buffer); // place, volume and mass: all of theirs have 1 and 1
    particles = count;
    tail = new Float64Array(numbers * count);
    const middle = [0, 1].map((a) => Math.floor(Math.max(...given.filter((_, k) => k % 4 === a)) / theirs.dx / 2));
    for (let i = 0; i < count; i++) {
      const place = [0, 1].map((a) => given[4 * i + a] + (theirs.n / 2 - middle[a]) * theirs.dx); // by whole cells
      tail.set(gather(new theirs.Particle(place, 0)), i * numbers);
    }
  } else if (message.do === 'set') {
    dt = message.dt;
  } else {
    const states = message.states || 1;
    tail = new Float64Array(read(8 * numbers * count * states).buffer);
    for (let s = 0; s < states; s++) step(tail.subarray(s * numbers * count, (s + 1) * numbers * count), message.steps);
  }
  write(Buffer.from(JSON.stringify(head) + '\n'));
  write(Buffer.from(tail.buffer, tail.byteOffset, tail.byteLength));
}
