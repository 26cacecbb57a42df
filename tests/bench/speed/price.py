#!/usr/bin/python3
"""What a scene costs on several drives: millions of instructions by stage, and milliseconds where the stage is timed.

A drive is NAME:INI:SENSORS:LOG, or NAME:INI:SENSORS:LOG:SHORTER with a log that is the beginning of the first one: its cost
is taken off, so that the start of the program is left out. Runs have one thread; callgrind counts the instructions. The
milliseconds are of the longer log without callgrind (timing.json), of stages by the clock, of all as CPU time with the
start; other programs at work make them longer, instructions stay the same.

  for n in 9 19; do build/bin/perception-import kitti ... --last $n -o out/k$n.rawlog; done
  tests/bench/speed/price.py demo:ini/demo.ini:C+L+R:rawlogs/demo.rawlog front:ini/kitti.ini:L:out/k19.rawlog:out/k9.rawlog

Writes OUT/price.json. --base: that of another version [tests/bench/speed/price.json: of the last release]; stages that
grew by more than 5 % are marked, and the program ends with 1. --peer: whole_bench, which runs the same drives beside
pipelines of other libraries.
"""
import argparse
import json
import os
import re
import subprocess
import sys

# Stages by the function that has them; what they call is theirs.
STAGES = {
    'read': r'RawlogReader::readEntry\(',
    'decode': r'Pipeline::addFrame\(',
    'ground': r'ScanMaker::addGround\(',
    'weather, trust': r'ScanMaker::weighReturns\(',
    'front ends': r'FrontEnd::extract\(',
    '- linking': r'perception::linkInSpace\(',
    '- descriptors': r'ClusterDescriber::describe\(',
    '- classifier': r'ClusterClassifier::probabilities\(',
    'filter': r'Pipeline::filter\(',
    '- likelihoods': r'perception::likelihoodTable\(',
    '- ranking': r'perception::rankChildren\(',
    'grid': r'Pipeline::addToGrid\(',
    'path, scene': r'Pipeline::addOutput\(',
    'result files': r'LogRun::put\(',
    'all': r'PROGRAM TOTALS',
}
TIMED = {'read': ['read'], 'decode': ['decode'], 'ground': ['ground'], 'weather, trust': ['weather', 'weather_state'],
         'front ends': ['lidar', 'radar', 'boxes'], 'filter': ['filter'], 'path, scene': ['scene']}
GROWN = 1.05


def track(args, log, out, under=()):
    command = list(under) + [args.track, '-c', args.config, '-i', log, '-o', out, '--threads', '1', '--overwrite']
    for value in args.set:
        command += ['--set', value]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: warnings
        sys.exit(done.stdout + done.stderr)
    with open(os.path.join(out, 'done.json')) as f:
        return json.load(f)['scenes']


def instructions(args, log, name):
    """Millions of instructions by stage, and the number of scenes."""
    out = os.path.join(args.output, name)
    counts = out + '.%p.callgrind'
    scenes = track(args, log, out, ['valgrind', '--tool=callgrind', '--callgrind-out-file=' + counts])
    files = [os.path.join(args.output, f) for f in os.listdir(args.output)
             if re.fullmatch(re.escape(name) + r'\.\d+\.callgrind', f)]
    largest = max(files, key=total)  # the supervisor's own is small
    text = subprocess.run(['callgrind_annotate', '--inclusive=yes', '--threshold=100', '--show-percs=no', largest],
                          capture_output=True, text=True, check=True).stdout
    for f in files:
        os.remove(f)
    cost = {}
    for stage, pattern in STAGES.items():
        lines = [line for line in text.splitlines() if re.match(r'\s*[\d,]+ +\S', line) and re.search(pattern, line)]
        found = [int(line.split()[0].replace(',', '')) for line in lines]
        cost[stage] = max(found, default=0) / 1e6
    return cost, scenes


def total(file):
    with open(file) as f:
        return max((int(line.split()[1]) for line in f if re.match(r'(summary|totals):', line)), default=0)


def milliseconds(args, log):
    out = os.path.join(args.output, 'timed')
    scenes = track(args, log, out)
    with open(os.path.join(out, 'timing.json')) as f:
        timing = json.load(f)
    seconds = {stage['name']: stage['seconds'] for stage in timing['stages']}
    of_stage = {stage: 1e3 * sum(seconds.get(n, 0) for n in names) / scenes for stage, names in TIMED.items()}
    return {**of_stage, 'all': 1e3 * timing['cpu_seconds'] / scenes}


def price(args, drive):
    """Millions of instructions a scene by stage, and milliseconds."""
    name, config, sensors, long, *short = drive.split(':')
    args.config, args.set = config, ['run.sensors=' + sensors]
    cost, scenes = instructions(args, long, name)
    if short:
        less, fewer = instructions(args, short[0], name + '_short')
        if scenes <= fewer:
            sys.exit('%s has no more scenes than %s' % (long, short[0]))
        cost, scenes = {stage: cost[stage] - less[stage] for stage in cost}, scenes - fewer
    return {stage: c / scenes for stage, c in cost.items()}, milliseconds(args, long)


def show(name, cost, times, base):
    """Prints a drive's table; whether a stage grew."""
    print('%-16s %14s %8s' % (name, 'M instructions', 'ms'))
    grew = False
    for stage, c in cost.items():
        time = '%8.2f' % times[stage] if stage in times else ' ' * 8
        before = base.get(stage)
        more = bool(before) and c > GROWN * before
        print('%-16s %14.2f %s%s' % (stage, c, time, '' if not before else '  before %.2f%s' % (before, ', GREW' if more else '')))
        grew |= more
    return grew


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('drives', nargs='+', metavar='NAME:INI:SENSORS:LOG[:SHORTER]')
    parser.add_argument('-o', '--output', default='out/price')
    parser.add_argument('--track', default='build/bin/perception-track')
    parser.add_argument('--base', default='tests/bench/speed/price.json')
    parser.add_argument('--peer', help='build-bench/bin/whole_bench')
    args = parser.parse_args()
    for drive in args.drives:
        if drive.count(':') not in (3, 4):
            parser.error('%s: expected NAME:INI:SENSORS:LOG or NAME:INI:SENSORS:LOG:SHORTER' % drive)
    os.makedirs(args.output, exist_ok=True)
    base = {}
    if os.path.exists(args.base):
        with open(args.base) as f:
            base = json.load(f)
    prices, grew = {}, False
    for drive in args.drives:
        name = drive.split(':')[0]
        prices[name], times = price(args, drive)
        grew |= show(name, prices[name], times, base.get(name, {}))
    with open(os.path.join(args.output, 'price.json'), 'w') as f:
        json.dump(prices, f, indent=1)
        f.write('\n')
    if args.peer:
        parts = [drive.split(':') for drive in args.drives]
        subprocess.run([args.peer] + [word for p in parts for word in (p[1], p[3], p[2])], check=True)
    return 1 if grew else 0


if __name__ == '__main__':
    sys.exit(main())
