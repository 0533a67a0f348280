# An adapter for your code in Julia. Fill in the five places, then: mpmstab spectrum -program 'julia mine.jl'
# Standard output is for mpmstab. The adapter needs no package. It has been read against the protocol and never been run.

# FILL 1: the state: all that a step changes and a later step reads. The last index is the particle.
state = (x = zeros(2, 8), v = zeros(2, 8), stress = zeros(3, 8))

# FILL 2: the number of directions, the width of a cell, and the period of each direction (null: it has no period).
grid = "\"dim\": 2, \"cell_width\": 0.1, \"periodic\": [null, null]"

# FILL 3: the parameters that mpmstab may set, with the values of your code.
parameters = Dict("dt" => 1e-4)

# FILL 4: the field that is the place. Where you know it, the size of a usual change of another field: (v = ", \"scale\": 20",).
known = (x = ", \"place\": true",)

# FILL 5: one step. It changes the arrays of the state, and keeps nothing else.
step!(state, parameters) = error("FILL 5: one step of your code")

# Below is the protocol: a line of JSON, and after it doubles, particle by particle.
const answers = stdout
redirect_stdout(stderr)
pack(of) = vcat(values(of)...)

function unpack!(of, all)
    first = 1
    for field in values(of)
        n = size(field, 1)
        field .= all[first:first+n-1, :]
        first += n
    end
end

function describe(of)
    fields = join(("{\"name\": \"$name\", \"size\": $(size(of[name], 1))$(get(known, name, ""))}" for name in keys(of)), ", ")
    given = join(("\"$name\": $value" for (name, value) in parameters), ", ")
    "{\"protocol\": 1, \"name\": \"mine\", $grid, \"particles\": $(size(first(values(of)), 2)), " *
    "\"fields\": [$fields], \"parameters\": {$given}, \"steps\": 1, \"batch\": 64}"
end

number(line, name) = match(Regex("\"$name\"\\s*:\\s*([^,}\\s]+)"), line)

base = pack(state)
while !eof(stdin)
    line = readline(stdin)
    command = match(r"\"do\"\s*:\s*\"(\w+)\"", line)[1]
    head, tail = "{}", zeros(0)
    many = number(line, "states")
    states = many === nothing ? 1 : parse(Int, many[1]) # one after another
    given = command == "step" ? read!(stdin, Array{Float64}(undef, size(base)..., states)) : base
    try
        if command == "quit"
            break
        elseif command == "describe"
            head, tail = describe(state), base
        elseif command == "set"
            for name in keys(parameters)
                found = number(line, name)
                found === nothing || (parameters[name] = parse(Float64, found[1]))
            end
        else
            tail = similar(given)
            for at in 1:states
                unpack!(state, given[:, :, at])
                for _ in 1:parse(Int, number(line, "steps")[1])
                    step!(state, parameters)
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
