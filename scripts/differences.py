"""Prints what differs between two versions of the engine, in Markdown.

    python3 scripts/differences.py OLD NEW OLD_LIBRARY NEW_LIBRARY

OLD and NEW are versions such as 3.17.0. Compares their bindings and field tables in mujoco-sys and
the numbers in tests/oracle/recorded, and the schemas and messages of the two shared libraries.
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# A library prints its schema in a process of its own, because both have the same symbols.
PRINT_SCHEMA = """
import ctypes, sys
buffer = ctypes.create_string_buffer(1 << 22)
ctypes.CDLL(sys.argv[1]).mj_printSchema(None, buffer, len(buffer), 0, 0)
print(buffer.value.decode())
"""


def joined(text):
    return " ".join(text.split()).replace("( ", "(").replace(",)", ")").replace("::core::ffi::", "")


def bindings(version):
    """Returns the functions with their types, the fields of structs, and the constants."""
    text = (ROOT / f"mujoco-sys/src/bindings/v{version.replace('.', '_')}.rs").read_text()
    text = re.sub(r'#\[doc = "(\\.|[^"\\])*"\]', "", text)
    functions = {name: joined(rest) for name, rest in re.findall(r"pub fn (\w+)(\(.*?);\n", text, re.S)}
    fields = {}
    for struct, body in re.findall(r"pub (?:struct|union) (\w+) \{(.*?)\n\}", text, re.S):
        for name, kind in re.findall(r"pub (\w+): (.*?),\n", body + ",\n", re.S):
            fields[f"{struct.rstrip('_')}.{name}"] = joined(kind)
    constants = {name: joined(value) for name, value in re.findall(r"pub const (\w+): [^=]*= (.*?);\n", text, re.S)}
    return functions, fields, {name: value for name, value in constants.items() if name != "_"}


def shapes(version):
    """Returns kind, type and shape of the fields in the field table."""
    lines = (ROOT / f"mujoco-sys/fields/v{version.replace('.', '_')}.tsv").read_text().splitlines()[1:]
    cells = [line.split("\t") for line in lines]
    return {f"{owner}.{name}": f"{kind} {ctype} ({rows} x {columns})" for owner, kind, ctype, name, rows, columns, _ in cells}


def schema(library):
    """Returns the attributes, as `place attribute`."""
    text = subprocess.run([sys.executable, "-c", PRINT_SCHEMA, library], check=True, capture_output=True, text=True).stdout
    names, attributes = [], {}
    for line in filter(str.strip, text.splitlines()):
        rest = line
        # Names are indented by three columns for each level, and attributes begin in column 30.
        if line[:30].strip():
            name = re.match(r" *(\S+) +\((.)\)", line)
            del names[(len(line) - len(line.lstrip())) // 3 :]
            names.append(name[1])
            attributes["/".join(names)] = name[2]
            rest = line[name.end() :]
        attributes.update({f"{'/'.join(names)} {attribute}": "" for attribute in rest.split()})
    return attributes


def messages(library):
    """Returns the texts that read like a message: some words, on one line."""
    texts = re.findall(rb"[\t\n\x20-\x7e]{10,400}(?=\0)", Path(library).read_bytes())
    texts = {text.decode().strip() for text in texts}
    is_message = re.compile(r"(?=.*[a-z]{3})(\S+[ ]+){2,}\S+")
    return {text: "" for text in texts if is_message.fullmatch(text) and not re.search(r"[{};]|^\W|^N\d", text)}


def numbers(value, path=()):
    """Yields the place and the value of each number of a recording."""
    if isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from numbers(inner, (*path, key))
    elif isinstance(value, float):
        yield path, value


def moved(old, new):
    """Prints the largest differences of the recorded numbers."""
    print("\n## Numbers that moved\n")
    files = [ROOT / f"tests/oracle/recorded/{version}.json" for version in (old, new)]
    if not all(file.exists() for file in files):
        print(f"Not compared: {' or '.join(file.name for file in files)} is not in tests/oracle/recorded.")
        return
    was, now = (dict(numbers(json.loads(file.read_text()))) for file in files)
    # A place without the indices: humanoid.trajectory.qpos.
    groups = defaultdict(list)
    for place in was.keys() & now.keys():
        groups[".".join(part for part in place if isinstance(part, str))].append(place)
    print(f"{len(was.keys() ^ now.keys())} of {len(was.keys() | now.keys())} numbers are in one recording only.\n")
    print("| recorded | largest difference | largest number |\n|---|---|---|")
    for group, places in sorted(groups.items()):
        difference = max(abs(was[place] - now[place]) for place in places)
        if difference > 0:
            print(f"| {group} | {difference:.1e} | {max(abs(was[place]) for place in places):.3g} |")


def only_in(one, other):
    """Returns the sorted keys, without parts of an element of the schema that is in the list too."""
    keys = one.keys() - other.keys()
    return sorted(key for key in keys if re.sub(r"[ /][^ /]+$", "", key) not in keys)


def compare(title, old, new):
    """Prints what is new, gone and changed."""
    print(f"\n## {title}\n")
    changed = [f"`{key}`: `{old[key]}`, now `{new[key]}`" for key in sorted(old.keys() & new.keys()) if old[key] != new[key]]
    kinds = [
        ("new", [f"`{key}` {new[key] and f'`{new[key]}`'}".strip() for key in only_in(new, old)]),
        ("gone", [f"`{key}`" for key in only_in(old, new)]),
        ("changed", changed),
    ]
    for kind, lines in kinds:
        print(f"- {kind}: {len(lines)}")
        for line in lines:
            print(f"  - {line}")


def undecided(old, new):
    """Prints new fields that a table of decisions does not name."""
    print("\n## Without a decision\n")
    tables = ["build/knowledge/derivative.tsv", "build/knowledge/writable.tsv", "build/knowledge/derived.tsv"]
    known = [set(re.findall(r"[\w.]+", (ROOT / table).read_text())) for table in tables]
    for table, names in zip(tables, known):
        is_array = "derivative" not in table
        fields = [
            field.removeprefix("Model.")
            for field, shape in shapes(new).items()
            if field.startswith("Model.") and field not in shapes(old)
            and (not is_array or re.match("array (mjtNum|float)", shape))
        ]
        print(f"- `{table}`: {', '.join(field for field in fields if field not in names) or 'none'}")


def main():
    old, new, old_library, new_library = sys.argv[1:]
    print(f"# MuJoCo {new} compared with {old}")
    for title, was, now in zip(["Functions", "Fields of structs", "Constants"], bindings(old), bindings(new)):
        compare(title, was, now)
    compare("Kinds and shapes of fields", shapes(old), shapes(new))
    compare("Schema", schema(old_library), schema(new_library))
    compare("Messages", messages(old_library), messages(new_library))
    moved(old, new)
    undecided(old, new)


if __name__ == "__main__":
    main()
