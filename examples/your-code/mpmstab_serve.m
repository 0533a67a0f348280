function mpmstab_serve(step, state, about)
% Your step as a program, in Octave and MATLAB: mpmstab spectrum -program 'octave -q serve.m'
%
%   mpmstab_serve(@(state, parameters) ..., struct('x', x, 'v', v), struct('cell_width', h, ...))
%
% step: takes the state and a structure of parameters, and returns the state after one step.
% state: arrays with particles as first index.
% about: cell_width; and where they are needed periodic (a period for each direction, NaN where there is none),
% place (the name of the place, without it 'x'), scale (scale.v = 20), parameters (parameters.dt = 1e-4), name, steps.
% Octave sends what the step prints to standard error. In MATLAB the step must print nothing.
in = fopen('/dev/stdin', 'r');
out = fopen('/dev/stdout', 'w');
in_octave = exist('OCTAVE_VERSION', 'builtin') > 0;
if in_octave, dup2(stderr, stdout); end
about = with(about, struct('place', 'x', 'scale', struct(), 'parameters', struct(), 'name', 'mine', 'steps', 1));
names = fieldnames(state);
fields = cell(1, numel(names));
for k = 1:numel(names)
  fields{k} = struct('name', names{k}, 'size', size(state.(names{k}), 2), 'place', strcmp(names{k}, about.place));
  if isfield(about.scale, names{k}), fields{k}.scale = about.scale.(names{k}); end
end
base = gather(state);
dim = size(state.(about.place), 2);
about = with(about, struct('periodic', NaN(1, dim)));
parameters = about.parameters;
line = next_line(in);
while ~isempty(line)
  message = jsondecode(strrep(line, '"do"', '"command"')); % 'do' is a word of Octave's language
  head = '{}';
  tail = [];
  try
    switch message.command
      case 'quit', return
      case 'describe'
        head = jsonencode(struct('protocol', 1, 'name', about.name, 'dim', dim, 'cell_width', about.cell_width, ...
                                 'periodic', {num2cell(about.periodic)}, 'particles', size(base, 1), ...
                                 'fields', {fields}, 'parameters', parameters, 'steps', about.steps));
        tail = base;
      case 'set', parameters = with(rmfield(message, 'command'), parameters);
      case 'step'
        now = scatter(fread(in, [size(base, 2), size(base, 1)], 'double').', state);
        for n = 1:message.steps, now = step(now, parameters); end
        tail = gather(now);
    end
  catch wrong
    head = jsonencode(struct('error', wrong.message));
    tail = [];
  end
  fwrite(out, [head, char(10)]);
  fwrite(out, tail.', 'double');
  if in_octave, fflush(out); end
  line = next_line(in);
end
end

function line = next_line(in)
% Byte by byte: fgetl of Octave waits for the byte after the line.
line = '';
byte = fread(in, 1);
while ~isempty(byte) && byte ~= 10
  line(end + 1) = char(byte);
  byte = fread(in, 1);
end
end

function s = with(s, defaults)
for name = fieldnames(defaults).', if ~isfield(s, name{1}), s.(name{1}) = defaults.(name{1}); end, end
end

function q = gather(state)
q = cellfun(@double, struct2cell(state).', 'UniformOutput', false);
q = [q{:}];
end

function state = scatter(q, state)
for name = fieldnames(state).'
  a = state.(name{1});
  state.(name{1}) = cast(q(:, 1:size(a, 2)), class(a));
  q(:, 1:size(a, 2)) = [];
end
end
