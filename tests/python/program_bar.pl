#!/usr/bin/perl
# The bar of examples/your-code as a program, written from the section 'Messages' of examples/your-code/PROGRAM.md alone.
use strict;
use warnings;
use JSON::PP;

binmode $_, ':raw' for *STDIN, *STDOUT;
my ($cells, $particles, $dt, $h) = (16, 32, 1 / 32, 1 / 16);

sub answer {
    my ($head, @numbers) = @_;
    print STDOUT encode_json($head), "\n", pack('d<*', @numbers);
    STDOUT->flush();
}

# Hat functions, stress last: numbers x, v, stress of each particle.
sub step {
    my @p = @_;
    my (@mass, @momentum, @force) = ();
    my $visit = sub {
        my ($i, $do) = @_;
        my $c = int($p[3 * $i] / $h);
        my $w = $p[3 * $i] / $h - $c;
        $do->($c % $cells, 1 - $w, -1 / $h);
        $do->(($c + 1) % $cells, $w, 1 / $h);
    };
    for my $i (0 .. $particles - 1) {
        $visit->($i, sub {
            my ($n, $w, $g) = @_;
            $mass[$n] += $w * $h / 2;
            $momentum[$n] += $w * $h / 2 * $p[3 * $i + 1];
            $force[$n] -= $g * $h / 2 * $p[3 * $i + 2];
        });
    }
    for my $i (0 .. $particles - 1) {
        my ($dx, $dv, $ds) = (0, 0, 0);
        $visit->($i, sub {
            my ($n, $w, $g) = @_;
            my $v = ($momentum[$n] + $dt * $force[$n]) / $mass[$n];
            $dv += $dt * $w * $force[$n] / $mass[$n];
            $ds += $dt * $g * $v;
            $dx += $dt * $w * $v;
        });
        $p[3 * $i] += $dx;
        $p[3 * $i] -= 1 if $p[3 * $i] >= 1;
        $p[3 * $i] += 1 if $p[3 * $i] < 0;
        $p[3 * $i + 1] += $dv;
        $p[3 * $i + 2] += $ds;
    }
    return @p;
}

my @base = map { (($_ + 0.5) / $particles, 0, 0) } 0 .. $particles - 1;
while (my $line = <STDIN>) {
    my $message = decode_json($line);
    if ($message->{do} eq 'describe') {
        answer({protocol => 1, name => 'bar in Perl', dim => 1, cell_width => $h, periodic => [1], particles => $particles,
                fields => [{name => 'x', size => 1, place => JSON::PP::true}, {name => 'v', size => 1, scale => 1},
                           {name => 'stress', size => 1, scale => 1}],
                parameters => {dt => $dt}, batch => 8}, @base);
    } elsif ($message->{do} eq 'set') {
        $dt = $message->{dt} if exists $message->{dt};
        answer({});
    } elsif ($message->{do} eq 'step') {
        my @after;
        for my $state (1 .. $message->{states} // 1) {
            read(STDIN, my $bytes, 8 * 3 * $particles) == 8 * 3 * $particles or exit 1;
            my @p = unpack('d<*', $bytes);
            @p = step(@p) for 1 .. $message->{steps};
            push @after, @p;
        }
        answer({}, @after);
    } else {
        last;
    }
}
