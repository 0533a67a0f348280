# An adapter for your code in Julia. Fill in the five places, then: mpmstab spectrum -program 'julia mine.jl'
# mpmstab chooses the particles: 10 cells each way with 2 particles each way, or those of -program_scene.
# Standard output is for mpmstab. The adapter needs no package. It has been read against the protocol and never been run.

# FILL 1: one particle at rest: the names and values of all that a step changes and a later step reads, and what else differs
# from particle to particle.
rest = (x = zeros(2), v = zeros(2), stress = zeros(3), volume = ones(1), mass = ones(1))

# FILL 2: the number of directions, and the width of a cell. mpmstab adds the period of each direction, 0 where there is none.
grid = Dict{String,Any}("dim" => 2, "cell_width" => 0.1)

# FILL 3: the parameters that mpmstab may set, with the values of your code.
parameters = Dict("dt" => 1e-4)

# FILL 4: which of the names above is the place, and which are the volume and the mass (nothing where they are not there).
roles = (place = :x, volume = :volume, mass = :mass)

# FILL 5: one step. It changes the arrays of the state, whose last index is the particle, and keeps nothing else.
step!(state, parameters, grid) = error("FILL 5: one step of your code")

# Below is the protocol: a line of JSON, and after it doubles, particle by particle.
const answers = stdout
redirect_stdout(stderr)
pack(of) = vcat(values(of)...)

# A state of arrays, whose last index is the particle, from the numbers of all particles.
function unpack(all)
    ends = cumsum([length(values) for values in rest])
    NamedTuple{keys(rest)}(Tuple(all[last-length(values)+1:last, :] for (last, values) in zip(ends, rest)))
end

function arrange(given)
    of = map(values -> repeat(values, 1, size(given, 2)), rest)
    dim = grid["dim"]
    for (name, rows) in ((roles.place, 1:dim), (roles.volume, dim+1:dim+1), (roles.mass, dim+2:dim+2))
        name === nothing || (of[name] .= given[rows, :])
    end
    of
end

function describe()
    fields = join(("{\"name\": \"$name\", \"size\": $(length(rest[name])), \"place\": $(name == roles.place)}" for name in keys(rest)), ", ")
    given = join(("\"$name\": $value" for (name, value) in parameters), ", ")
    "{\"protocol\": 1, \"name\": \"mine\", \"dim\": $(grid["dim"]), \"cell_width\": $(grid["cell_width"]), \"scenes\": true, " *
    "\"fields\": [$fields], \"parameters\": {$given}, \"batch\": 64}"
end

number(line, name) = match(Regex("\"$name\"\\s*:\\s*([^,}\\s]+)"), line)
whole(line, name, default) = (found = number(line, name)) === nothing ? default : parse(Int, found[1])

particles = 0
while !eof(stdin)
    line = readline(stdin)
    command = match(r"\"do\"\s*:\s*\"(\w+)\"", line)[1]
    head, tail = "{}", zeros(0)
    count, states = whole(line, "particles", particles), whole(line, "states", 1) # states one after another
    rows = command == "scene" ? grid["dim"] + 2 : sum(length, rest)
    given = command in ("step", "scene") ? read!(stdin, Array{Float64}(undef, rows, count, states)) : zeros(0)
    try
        if command == "quit"
            break
        elseif command == "describe"
            head = describe()
        elseif command == "scene"
            global particles = count
            periods = match(r"\"periodic\"\s*:\s*\[([^\]]*)\]", line)[1]
            grid["periodic"] = [something(tryparse(Float64, strip(one)), 0.0) for one in split(periods, ",")]
            tail = pack(arrange(given[:, :, 1]))
        elseif command == "set"
            for name in keys(parameters)
                found = number(line, name)
                found === nothing || (parameters[name] = parse(Float64, found[1]))
            end
        else
            tail = similar(given)
            for at in 1:states
                state = unpack(given[:, :, at])
                for _ in 1:whole(line, "steps", 1)
                    step!(state, parameters, grid)
                end
                tail[:, :, at] = pack(state)
            end
        end
    catch wrong
        head, tail = "{\"error\": \"$(replace(sprint(showerror, wrong), '"' => '\'', '\n' => ' ', '\\' => '/'))\"}", zeros(0)
    end
    write(answers, head, "\n")
    write(answers, tail)
    flush(answers)
end
