#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""ratios.py OURS.jsonl THEIRS.jsonl: for each task that both have, the best peer's median over ours."""
import json
import sys


def load(path):
    rows = {}
    for line in open(path):
        r = json.loads(line)
        if r.get("median_s") is None:
            continue
        rows.setdefault((r["task"], r["size"]), []).append(r)
    return rows


def main():
    ours, theirs = load(sys.argv[1]), load(sys.argv[2])
    print(f"{'task':24} {'size':30} {'ours':>10} {'peer':>10} {'ratio':>7}  {'MB':>6} {'peer MB':>8}  peer")
    for key, mine in ours.items():
        for own in mine:
            # Reading tasks carry the file's name in the peer: compare only the same file.
            name = own["peer"].split(":", 1)[-1]
            rivals = [r for r in theirs.get(key, []) if key[0] not in ("read_file", "write_file") or r["peer"].split(":", 1)[-1] == name]
            label = key[1] if key[0] not in ("read_file", "write_file") else name
            if not rivals:
                print(f"{key[0]:24} {label:30} {own['median_s'] * 1e3:8.2f}ms {'-':>10} {'-':>7}  {own.get('peak_rss_mb', 0):6.0f}")
                continue
            best = min(rivals, key=lambda r: r["median_s"])
            print(f"{key[0]:24} {label:30} {own['median_s'] * 1e3:8.2f}ms {best['median_s'] * 1e3:8.2f}ms {best['median_s'] / own['median_s']:6.2f}x"
                  f"  {own.get('peak_rss_mb', 0):6.0f} {best.get('peak_rss_mb', 0):8.0f}  {best['peer']}")


main()
