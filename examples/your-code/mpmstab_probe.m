function varargout = mpmstab_probe(path, h, varargin)
% One call in your own time loop writes the matrix of your step, in Octave and MATLAB:
%
%   [xp, vp, sp] = mpmstab_probe('A.mtx', h, xp, vp, sp);     first line of the time loop
%   mpmstab spectrum -matrix A.mtx                            afterwards
%   mpmstab symbol -matrix_blocks A.mtx                       all waves, where all cells are alike
%
% h: the width of a cell; [h Lx Ly] for a grid with periods, Inf where there is none. The first array is the place; the
% others are all that a step changes and a later step reads. Particles are the first or the last index. One more output
% is true as long as the loop has to do steps for the probe, and false when the state is your own again:
%
%   [xp, vp, sp, busy] = mpmstab_probe('A.mtx', h, xp, vp, sp);
%
% Each call keeps the answer to the last perturbation, restores the state and perturbs other unknowns. The last one
% writes the matrix and restores the state to the last bit. To probe again: clear mpmstab_probe.
% mpmstab_probe.h says how it is done and what the comments in the file mean.
persistent hooks
if isempty(hooks), hooks = containers.Map(); end
if ~isKey(hooks, path)
  w = begin(h, varargin);
else
  w = hooks(path);
  if strcmp(w.stage, 'done')
    varargout = [varargin, {false}];
    return
  end
  w = take(w, path, gather(varargin, w.n));
end
busy = ~strcmp(w.stage, 'done');
if busy
  [w, q] = perturb(w);
  if strcmp(w.stage, 'first') && w.asked == 1, q = gather(varargin, w.n); end % the loop goes on from where it is
  if strcmp(w.stage, 'first') && w.asked == 3, q = w.answer{1}; end
else
  q = w.base;
  w = struct('stage', 'done');
end
hooks(path) = w;
varargout = [scatter(q, varargin), {busy}];
end

function q = gather(arrays, n)
q = [];
for k = 1:numel(arrays)
  a = double(arrays{k});
  if size(a, 1) == n, a = reshape(a, n, []); else, a = reshape(a, [], n).'; end
  q = [q, a];
end
end

function arrays = scatter(q, arrays)
n = size(q, 1);
for k = 1:numel(arrays)
  a = arrays{k};
  width = numel(a) / n;
  values = q(:, 1:width);
  q(:, 1:width) = [];
  if size(a, 1) ~= n, values = values.'; end
  arrays{k} = cast(reshape(values, size(a)), class(a));
end
end

function w = begin(h, arrays)
w = struct('stage', 'rest', 'n', max(size(arrays{1})), 'asked', 0, 'calls', 0, 'number', 1, 'colour', 1);
w.base = gather(arrays, w.n);
w.single = [];
w.of = []; % the field of each number
w.value = zeros(numel(arrays), 1);
w.names = '';
for k = 1:numel(arrays)
  width = numel(arrays{k}) / w.n;
  w.value(k) = max(abs(double(arrays{k}(:))));
  w.single = [w.single, repmat(isa(arrays{k}, 'single'), 1, width)];
  w.of = [w.of, repmat(k, 1, width)];
  w.names = sprintf('%s field%d %d%s', w.names, k, width, repmat(' place', 1, double(k == 1)));
end
w.cell = h(1);
w.size = 2^-17;
if any(w.single), w.size = 2^-5; end
w.epsilon = 2.^(-52 + 29 * w.single);
w.apart = false(size(w.of));
w = begin_scales(w);
w.dim = numel(arrays{1}) / w.n;
period = [h(2:end), Inf(1, w.dim)];
w.period = [period(1:w.dim), Inf(1, numel(w.scale) - w.dim)];
% Bins as wide as cells.
x = w.base(:, 1:w.dim);
low = min(x, [], 1);
w.periodic = isfinite(period(1:w.dim));
w.bins = floor((max(x, [], 1) - low) / h(1)) + 1;
w.bins(w.periodic) = ceil(period(w.periodic) / h(1) - 1e-6);
for a = find(w.periodic), x(:, a) = mod(x(:, a), period(a)); end
low(w.periodic) = 0;
w.bin = min(floor((x - low) / h(1)), w.bins - 1);
[~, w.middle] = min(sum(abs(w.base(:, 1:w.dim) - (min(w.base(:, 1:w.dim), [], 1) + max(w.base(:, 1:w.dim), [], 1)) / 2), 2));
w.reach = 0; % in bins; -1: not known, each column has calls of its own
end

function d = minus_periods(w, one, other)
d = one - other;
p = isfinite(w.period);
d(:, p) = d(:, p) - w.period(p) .* round(d(:, p) ./ w.period(p));
end

function most = largest(w, d)
% Over the scales, of numbers that are not set apart.
most = max(max(abs(d(:, ~w.apart)) ./ w.scale(~w.apart)));
end

% ---- scales: mpmstab_scales.h says how they are found; names are those of its struct, d is scale ----

function w = begin_scales(w)
n = numel(w.value);
[~, first] = unique(w.of, 'first');
w.least = 100 * w.epsilon(first).' .* w.value;
w.d = w.value;
w.d(w.value == 0) = 1e-12;
w.d(1) = w.cell;
w.known = w.value > 0;
w.known(1) = true;
w.at = zeros(n, 1);
w.couples = zeros(n);
w.lost = zeros(n);
w.passes = 0;
w.unsettled = 0;
w.scale = w.d(w.of).';
end

function reach = connected(reach)
% Which reach which through others (Warshall 1962).
for k = 1:size(reach, 1), reach = reach | (reach(:, k) & reach(k, :)); end
end

function w = next_scale(w)
% The next field that is perturbed is w.number. When scales are known, it is looked how far a particle reaches.
w.stage = 'scales';
while isfinite(w.unsettled)
  w.number = find(abs(log2(w.d ./ w.at)) > 1, 1);
  if ~isempty(w.number)
    w.at(w.number) = w.d(w.number);
    w.scale = w.d(w.of).';
    return
  end
  [w, changed] = find_scales(w);
  w.passes = w.passes + 1;
  if ~changed
    w.unsettled = max(abs(log2(w.d ./ w.at)));
    if any(any(w.lost .* w.couples.' > 1e-3)), w.unsettled = Inf; end
    w.d(2:end) = 2.^round(log2(w.d(2:end)));
    break
  elseif w.passes > 60
    w.unsettled = Inf;
  end
end
w.scale = w.d(w.of).';
w.stage = 'first';
w.number = 1;
end

function w = take_scale(w, one, other)
change = max(abs(minus_periods(w, one, other)), [], 1) / 2;
change = accumarray(w.of(:), change(:), [], @max);
amount = w.size * w.at(w.number);
seen = change >= w.least;
w.lost(:, w.number) = ~seen .* max(change, w.least / 100) / amount;
w.lost(w.number, w.number) = 0;
w.couples(seen, w.number) = change(seen) / amount;
end

function [w, changed] = find_scales(w)
n = numel(w.d);
old = w.d;
known = w.known;
feels = w.couples > 0;
feels(1, :) = false;
feels(:, 1) = false;
feels = connected(feels | logical(eye(n)));
w.set_of = feels & feels.';
for f = 2:n
  members = find(w.set_of(f, :));
  if members(1) ~= f, continue, end
  for sweep = 1:100
    for i = members
      others = members(members ~= i);
      gets = w.couples(i, others) * w.d(others);
      gives = sum(w.couples(others, i) ./ w.d(others));
      if gets > 0 && gives > 0, w.d(i) = sqrt(gets / gives); end
    end
  end
  [factor, known_now] = factor_of(w, members, old, known);
  w.known(members) = known_now;
  w.d(members) = factor * w.d(members);
end
gets = max(w.couples .* w.d.' .* ~eye(n), [], 2);
limit = max(w.value, 1e3 * gets);
limit(limit == 0 | ~w.known) = Inf;
limit(1) = Inf;
w.d = min(w.d, limit);
changed = any(w.known ~= known) || any(abs(log(w.d ./ old)) > 0.01);
end

function [factor, is_known] = factor_of(w, members, old, known)
d = w.d(members);
known(members) = false;
inward = max([w.value(members) ./ d; reshape(w.couples(members, known) .* old(known).' ./ d, [], 1)]);
known(1) = false;
out = max([0; reshape(w.couples(known, members) .* d.' ./ old(known), [], 1)]);
moves = max(w.couples(1, members) .* d.') / w.cell;
factor = inward;
if moves > 0
  factor = min(max(inward, 1e-3 / moves), 1 / moves);
elseif inward == 0 && out > 0
  factor = 1 / out;
end
middle = exp(mean(log(d)));
most = 1;
if numel(members) > 1, most = 1e10; end
is_known = factor > 0 || w.known(members(1)) || middle >= most;
if factor > 0, return, end
factor = 1 / middle;
if is_known, return, end
step = 1e8;
if w.size >= 1e-3, step = 1e3; end
if numel(members) > 1, factor = step; else, factor = min(step, factor); end
end

function [w, q] = perturb(w)
% Asks for a step from +s and -s of one number of the particles of a colour, +2s and -2s, or +-s at random of all.
size_of = w.size * [1 -1 2 -2];
amount = zeros(size(w.base));
switch w.stage
  case 'scales',  amount(:, w.of == w.number) = 1;
  case 'reach',   amount(w.middle, w.number) = 1;
  case 'columns', amount(w.colour_of == w.colour, w.number) = 1;
  case 'check',   amount(:, ~w.apart) = 1;
  case 'first',   amount(:) = w.asked == 0;
  case 'last',    amount(:) = 1;
end
if any(strcmp(w.stage, {'scales', 'check', 'first', 'last'})) % rand would change the code's own
  amount(:) = amount(:).' .* (2 * mod((1:numel(amount)) * 0.6180339887498949, 1) - 1);
end
q = w.base + size_of(w.asked + 1) * amount .* w.scale;
q(:, w.single == 1) = double(single(q(:, w.single == 1)));
w.amount{w.asked + 1} = q - w.base;
w.calls = w.calls + 1;
end

function w = take(w, path, answer)
% Takes one more answer, and says what comes next.
if ~all(isfinite(answer(:))) && strcmp(w.stage, 'scales')
  w.unsettled = Inf;
  w.d = w.value;
  w.d(w.value == 0) = 1;
  w.d(1) = w.cell;
  w.asked = 0;
  w = next_scale(w);
  return
end
if ~all(isfinite(answer(:)))
  fprintf(2, 'mpmstab_probe: the state after a step has a number that is not finite; %s is not written\n', path);
  w.stage = 'done';
  return
end
w.asked = w.asked + 1;
w.answer{w.asked} = answer;
if w.asked < 1 + 3 * any(strcmp(w.stage, {'columns', 'first'})) + any(strcmp(w.stage, {'check', 'scales'})), return, end
w.asked = 0;
switch w.stage
  case 'rest'
    w.rest = answer;
    w = next_scale(w);
  case 'scales'
    w = take_scale(w, w.answer{1}, w.answer{2});
    w = next_scale(w);
  case 'first'
    if isequal(w.answer{1}, w.answer{2}) && ~isequal(w.answer{1}, w.base)
      error('mpmstab_probe: no field moved in %d steps: does the loop step other arrays?', w.calls);
    end
    [w.first, w.again] = w.answer{[1 3]};
    w.two_steps = largest(w, minus_periods(w, w.answer{2}, w.answer{4}));
    w.repeat = largest(w, minus_periods(w, w.again, w.rest));
    w.stage = 'reach';
  case 'reach'
    touched = any(abs(minus_periods(w, answer, w.rest)) ./ w.scale > 10 * w.repeat, 2);
    d = abs(w.bin - w.bin(w.middle, :));
    d(:, w.periodic) = min(d(:, w.periodic), w.bins(w.periodic) - d(:, w.periodic));
    w.reach = max([w.reach; max(d(touched, :), [], 2)]);
    w.number = w.number + 1;
    if w.number > numel(w.scale)
      w.reach = w.reach + 1; % particles elsewhere in a cell may reach one further
      w = begin_columns(w);
    end
  case 'columns'
    w = take_columns(w);
    w.number = w.number + 1;
    if w.number > numel(w.scale), w.number = 1; w.colour = w.colour + 1; end
    if w.colour > max(w.colour_of)
      w.entries = vertcat(w.entries{:});
      w = set_apart(w);
      w.stage = 'check';
    end
  case 'check'
    response = minus_periods(w, w.answer{1}, w.answer{2});
    given = (w.amount{1} - w.amount{2}).';
    expected = accumarray(w.entries(:, 1), w.entries(:, 3) .* given(w.entries(:, 2)), [numel(given), 1]);
    expected = reshape(expected, fliplr(size(w.base))).';
    w.additivity = largest(w, response - expected) / max([largest(w, response), largest(w, expected), realmin]);
    w.stage = 'last';
    limit = [1e-6, 1e-3];
    if any(w.single), limit = [1e-3, 0.05]; end
    if w.reach >= 0 && (w.leaks > limit(1) || w.additivity > limit(2))
      w.reach = -1; % some particle reaches further than was seen
      w = begin_columns(w);
    end
  case 'last'
    w.repeat = max(w.repeat, largest(w, minus_periods(w, w.first, answer)));
    w.stage = 'done';
    save_matrix(w, path);
end
end

function w = begin_columns(w)
% A direction repeats its colours every so many bins; what is left over at a period has colours of its own.
w.colour_of = (1:w.n).';
if w.reach >= 0
  colour = zeros(w.n, 1);
  for a = 1:w.dim
    n = w.bins(a);
    best = min(2 * w.reach + 1, n);
    whole = n;
    if w.periodic(a)
      try_these = best:n;
      [~, k] = min(try_these + mod(n, try_these));
      best = try_these(k);
      whole = floor(n / best) * best;
    end
    b = w.bin(:, a);
    b(b < whole) = mod(b(b < whole), best);
    b(w.bin(:, a) >= whole) = best + w.bin(w.bin(:, a) >= whole, a) - whole;
    colour = colour * (best + n - whole) + b;
  end
  [~, ~, place] = unique(w.bin, 'rows');
  [sorted, order] = sort(place(:));
  start = find([true; diff(sorted) ~= 0]);
  rank(order) = (1:w.n).' - start(cumsum([true; diff(sorted) ~= 0]));
  [~, ~, w.colour_of] = unique([colour, rank(:)], 'rows');
end
w.stage = 'columns';
w.colour = 1;
w.number = 1;
w.entries = {};
w.kinks = zeros(numel(w.scale));
w.sizes = w.kinks;
w.most = w.kinks; % the largest entry of each pair of numbers
w.own = zeros(1, numel(w.scale));
w.apart(:) = false;
w.leaks = 0;
end

function w = set_apart(w)
% Numbers that do not reach themselves through others, and whose own eigenvalue does not grow; none, if all were.
noise = 1e-8;
if any(w.single), noise = 1e-5; end
w.apart = ~(diag(connected(w.most > noise)).' | w.own > 1 + noise);
if all(w.apart), w.apart(:) = false; end
w.one_sided = max(max(w.kinks(~w.apart, ~w.apart)));
w.two_sizes = sum(sum(w.sizes(~w.apart, ~w.apart)));
w.repeat = largest(w, minus_periods(w, w.again, w.rest));
end

function owner = owners(w)
% The perturbed particle that each particle's answer is due to, or 0.
perturbed = find(w.colour_of == w.colour);
if w.reach < 0
  owner = repmat(perturbed, w.n, 1);
  return
end
owner = zeros(w.n, 1);
for j = perturbed.'
  d = abs(w.bin - w.bin(j, :));
  d(:, w.periodic) = min(d(:, w.periodic), w.bins(w.periodic) - d(:, w.periodic));
  owner(all(d <= w.reach, 2)) = j;
end
end

function w = take_columns(w)
width = numel(w.scale);
owner = owners(w);
due = owner > 0;
f = w.answer;
d = cellfun(@(amount) amount(owner(due), w.number), w.amount, 'UniformOutput', false);
both = minus_periods(w, f{1}, f{2});
unit = w.scale(w.number) ./ w.scale;
if any(~due), w.leaks = max(w.leaks, max(max(abs(both(~due, :)) ./ w.scale)) / (2 * w.size)); end
a = both(due, :) ./ (d{1} - d{2});
larger = minus_periods(w, f{3}, f{4});
ahead = minus_periods(w, f{1}, w.rest);
farther = minus_periods(w, f{3}, w.rest);
b = larger(due, :) ./ (d{3} - d{4});
near = ahead(due, :) ./ d{1} - a;
far = farther(due, :) ./ d{3} - b;
rounding = 4 * w.epsilon .* abs(w.base(due, :)) ./ w.scale / w.size; % of a difference quotient
w.kinks(:, w.number) = max(w.kinks(:, w.number), max(abs(2 * near - far) .* unit - rounding, [], 1).');
w.sizes(:, w.number) = w.sizes(:, w.number) + sum(((b - a) .* unit).^2, 1).';
entry = abs(a) .* unit;
itself = find(due) == owner(due);
w.own(w.number) = max([w.own(w.number); entry(itself, w.number)]);
entry(itself, w.number) = 0;
w.most(:, w.number) = max(w.most(:, w.number), max(entry, [], 1).');
row = (find(due) - 1) * width + (1:width);
column = repmat((owner(due) - 1) * width + w.number, 1, width);
there = a ~= 0;
w.entries{end + 1} = [row(there), column(there), a(there)];
end

function save_matrix(w, path)
% Matrix Market; unknowns particle by particle, fields in the order of the call.
says = sprintf('%% calls: %d\n%% moved: %.3g\n%% repeat: %.3g\n%% two_steps: %.3g\n%% one_sided: %.3g\n%% two_sizes: %.3g\n%% additivity: %.3g\n', ...
               w.calls, largest(w, minus_periods(w, w.rest, w.base)), w.repeat, w.two_steps, w.one_sided, sqrt(w.two_sizes), w.additivity);
period = w.period(1:w.dim);
period(~w.periodic) = 0;
known = [sprintf('%% size: %.3g\n%% single: %d\n%% numbers: %d\n', w.size, any(w.single), numel(w.scale)), ...
         sprintf('%% scale: %.17g\n', w.scale), sprintf('%% cell_width: %.17g\n%% period:', w.cell), ...
         sprintf(' %.17g', period), ...
         sprintf(['\n%% at:', repmat(' %.17g', 1, w.dim)], w.base(:, 1:w.dim).')];
from = 'found';
if ~(w.unsettled <= 1), from = 'guessed'; end
known = [known, sprintf('\n%% field_scale: %.17g cell_width field1', w.d(1))];
for k = 2:numel(w.d), known = [known, sprintf('\n%% field_scale: %.17g %s field%d', w.d(k), from, k)]; end
if numel(w.d) > 1, known = [known, sprintf('\n%% unsettled: %.3g', w.unsettled)]; end
[file, why] = fopen(path, 'w');
if file < 0, error('mpmstab_probe: %s cannot be written: %s', path, why); end
fprintf(file, '%%%%MatrixMarket matrix coordinate real general\n%% steps: 1\n%% fields:%s\n%s%s\n', w.names, says, known);
fprintf(file, '%d %d %d\n', numel(w.base), numel(w.base), size(w.entries, 1));
fprintf(file, '%d %d %.17g\n', w.entries.');
fclose(file);
fprintf(2, 'mpmstab_probe: %s has the matrix of your step, of order %d\n%s', path, numel(w.base), says);
end
