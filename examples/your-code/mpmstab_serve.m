function mpmstab_serve(step, state, about)
% Your step as a program, in Octave and MATLAB: mpmstab spectrum -program 'octave -q serve.m'
%   mpmstab_serve(@(state, parameters) ..., struct('x', x, 'v', v), struct('cell_width', h, ...))
% step: takes the state, whose arrays have particles as first index, and a structure of parameters; returns the state.
% about: cell_width; where they are needed, periodic (a period for each direction, NaN where there is none), place (the
% name of the place, without it 'x'), scale (scale.v = 20), parameters (parameters.dt = 1e-4), name, steps, and any_count
% (true: the step takes any number of particles). scenes: true: mpmstab chooses the particles. The state is that of one at rest; each
% gets a copy, with its place, and in the fields named by volume and mass what is its own. parameters.grid then has cell_width and
% periodic. scenes may also be a function that makes the state: @(grid, place, volume, mass) ... In Octave what the step prints goes to standard error. In MATLAB it
% must print nothing.
in = fopen('/dev/stdin', 'r');
out = fopen('/dev/stdout', 'w');
if exist('OCTAVE_VERSION', 'builtin'), dup2(stderr, stdout); end
[names, arrays] = deal(fieldnames(state).', struct2cell(state).');
widths = cellfun(@(a) size(a, 2), arrays);
doubles = @(state) cell2mat(cellfun(@double, struct2cell(state).', 'UniformOutput', false));
base = doubles(state);
about = with(about, struct('place', 'x', 'volume', '', 'mass', '', 'scale', struct(), 'scenes', false));
[own, make, grid] = deal({'place', 'volume', 'mass', 'scale', 'scenes'}, about.scenes, struct());
takes = isa(make, 'function_handle') || make;
dim = widths(strcmp(names, about.place));
about = with(about, struct('protocol', 1, 'name', 'mine', 'dim', dim, 'fields', {{}}, ...
                           'particles', size(base, 1), 'any_count', false, 'parameters', struct(), 'steps', 1, 'batch', 64));
if isfield(about, 'periodic'), about.periodic = num2cell(about.periodic); end % in JSON an array, also of one number
for k = 1:numel(names)
  about.fields{k} = struct('name', names{k}, 'size', widths(k), 'place', strcmp(names{k}, about.place));
  if isfield(about.scale, names{k}), about.fields{k}.scale = about.scale.(names{k}); end
end
while true
  line = '';
  while isempty(line) || line(end) ~= 10 % byte by byte: fgetl of Octave waits for the byte after the line
    line = [line, char(fread(in, 1))];
    if feof(in), return, end
  end
  message = jsondecode(strrep(line, '"do"', '"command"')); % 'do' is a word of Octave's language
  [head, tail] = deal(struct(), []);
  try
    switch message.command
      case 'quit', return
      case 'describe'
        [head, tail] = deal(with(struct('scenes', takes), rmfield(about, own)), base);
        if takes, [head, tail] = deal(rmfield(head, 'particles'), []); end
      case 'scene'
        given = fread(in, [dim + 2, message.particles], 'double').';
        [grid, about.particles] = deal(rmfield(message, {'command', 'particles'}), message.particles);
        tail = doubles(arrange(make, about, grid, state, given));
      case 'set', about.parameters = with(rmfield(message, 'command'), about.parameters);
      case 'step'
        message = with(message, struct('particles', about.particles, 'states', 1));
        tail = fread(in, [size(base, 2), message.particles * message.states], 'double').';
        for first = 1:message.particles:size(tail, 1) % one state after another
          these = first:first + message.particles - 1;
          for n = 1:message.steps
            now = mat2cell(tail(these, :), message.particles, widths);
            now = cellfun(@(of, a) cast(of, class(a)), now, arrays, 'UniformOutput', false);
            values = with(about.parameters, struct('grid', grid));
            tail(these, :) = doubles(orderfields(step(cell2struct(now, names, 2), values), state));
          end
        end
    end
  catch wrong
    [head, tail] = deal(struct('error', wrong.message), []);
  end
  fwrite(out, [jsonencode(head), char(10)]);
  fwrite(out, tail.', 'double');
  if exist('OCTAVE_VERSION', 'builtin'), fflush(out); end
end
end

function state = arrange(make, about, grid, rest, given)
[x, volume, mass] = deal(given(:, 1:end - 2), given(:, end - 1), given(:, end));
if isa(make, 'function_handle'), state = make(grid, x, volume, mass); return, end
state = structfun(@(a) repmat(a(1, :), size(given, 1), 1), rest, 'UniformOutput', false);
for role = {about.place, x; about.volume, volume; about.mass, mass}.', if ~isempty(role{1}), state.(role{1}) = role{2}; end, end
end

function s = with(s, defaults)
for name = fieldnames(defaults).', if ~isfield(s, name{1}), s.(name{1}) = defaults.(name{1}); end, end
end
