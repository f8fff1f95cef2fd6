"""Mistakes in the source by name, each behind a switch; for mutations.py. Needs `pip install tree-sitter
tree-sitter-rust`.

A mistake is `in` a function or a constant, named by as much of the end of its path as no other has:
`Search::division`, `units::LENGTHS`, `<Emd as Law>::respond` where a type has two of a name. `code` there,
without regard to how lines are broken, becomes `to`; `nth = "1 of 3"` says which, where it is there
several times: if there are no longer as many, somebody has to look. In what file an item lies, and what else
is in it, does not matter.
"""

import re
from pathlib import Path

import tree_sitter_rust
from tree_sitter import Language, Parser

ROOT = Path(__file__).resolve().parent.parent
# Code that is compiled before it runs, or written by a macro.
CLOSED = ("macro_invocation", "attribute_item", "line_comment", "block_comment")
CONSTANT = ("const_item", "static_item", "array_type", "const_block", "use_declaration")


class Unfit(Exception):
    """A mistake that cannot be planted."""


class File:
    """A source file with its tree."""

    def __init__(self, path):
        self.name, self.bytes = str(path.relative_to(ROOT)), path.read_bytes()
        self.root = Parser(Language(tree_sitter_rust.language())).parse(self.bytes).root_node


class Item:
    """A function or a constant."""

    def __init__(self, path, file, node):
        self.path, self.file, self.is_function = path, file, node.type == "function_item"
        self.inside = node.child_by_field_name("body" if self.is_function else "value")
        self.is_compiled = self.is_function and is_const(file, node)
        self.kind = None if self.is_function else node.child_by_field_name("type").text.decode()

    @property
    def name(self):
        return "::".join(part if isinstance(part, str) else part[-1] for part in self.path)


def is_const(file, node):
    return re.search(rb"\bconst\b", file.bytes[node.start_byte : node.child_by_field_name("name").start_byte])


def type_of(node):
    """The name of a type without what it is generic over."""
    return re.sub(r"<.*", "", node.text.decode(), flags=re.S).split("::")[-1].lstrip("&").strip()


def items(file, node, path):
    """All items below a node, but for tests."""
    is_test = False
    for child in node.named_children:
        if child.type == "attribute_item":
            is_test |= "test" in child.text.decode()
        elif child.type not in CLOSED:
            if not is_test:
                yield from items_of(file, child, path)
            is_test = False


def items_of(file, node, path):
    name, body = (node.child_by_field_name(field) for field in ("name", "body"))
    if node.type in ("function_item", "const_item", "static_item"):
        item = Item([*path, name.text.decode()], file, node)
        if item.inside is not None:
            yield item
            yield from items(file, item.inside, item.path)
    elif node.type == "impl_item":
        kind, trait = type_of(node.child_by_field_name("type")), node.child_by_field_name("trait")
        names = (kind, f"<{kind} as {type_of(trait)}>") if trait else (kind,)
        yield from items(file, body, [*path, names])
    elif node.type in ("mod_item", "trait_item"):
        if body is not None:
            yield from items(file, body, [*path, name.text.decode()])
    else:
        yield from items(file, node, path)


def source():
    """All items of the source."""
    found = []
    for path in sorted((ROOT / "src").rglob("*.rs")):
        room = [part for part in path.relative_to(ROOT / "src").with_suffix("").parts
                if part not in ("mod", "lib", "main")]
        file = File(path)
        found += items(file, file.root, room)
    return found


def item_of(found, wanted):
    parts = wanted.split("::")
    own = [item for item in found if len(item.path) >= len(parts) and all(
        wanted == part or wanted in part and not isinstance(part, str)
        for part, wanted in zip(item.path[-len(parts) :], parts))]  # fmt: skip
    if len(own) != 1:
        near = own or [item for item in found if item.path[-1] == parts[-1]]
        names = ", ".join(f"{item.name} ({item.file.name})" for item in near)
        raise Unfit(f"`{wanted}` stands for {len(own)} of {names}")
    return own[0]


def pattern(code):
    """Code without regard to how its lines are broken."""
    tokens = re.findall(r"\w+|[^\w\s]", code)
    # Code in brackets that is broken into lines ends with a comma.
    parts = [(r",?\s*" if token in ")]}" else "") + re.escape(token) for token in tokens]
    before = r"(?<![\w.])" if tokens[0][0].isdigit() else r"(?<!\w)" if tokens[0][0].isalpha() else ""
    return before + r"\s*".join(parts) + (r"(?!\w|\.\d)" if re.match(r"\w", tokens[-1]) else "")


def place(found, mutation):
    """The item of a mistake, and the range of bytes that it changes."""
    item = item_of(found, mutation["in"])
    text = item.file.bytes[item.inside.start_byte : item.inside.end_byte].decode()
    places = [match.span() for match in re.finditer(pattern(mutation["code"]), text)]
    nth, count = map(int, mutation.get("nth", "1 of 1").split(" of "))
    if len(places) != count:
        times = f"{len(places)} times, not {count}, in {item.name} ({item.file.name})"
        raise Unfit(f"`{mutation['code']}` stands {times}")
    if item.is_compiled:
        raise Unfit(f"{item.name} is computed by the compiler")
    begin, end = (item.inside.start_byte + len(text[:at].encode()) for at in places[nth - 1])
    return item, begin, end


def uses(item):
    """The places where functions of its file use a constant."""

    def walk(node, runs):
        if node.type in (*CONSTANT, "macro_invocation"):
            return
        if node.type == "function_item":
            body = node.child_by_field_name("body")
            if body is not None:
                yield from walk(body, not is_const(item.file, node))
        elif node.type in ("scoped_identifier", "identifier") and runs:
            if node.text.decode() in (item.path[-1], f"Self::{item.path[-1]}", f"self::{item.path[-1]}"):
                yield node.start_byte, node.end_byte
        else:
            for child in node.named_children:
                yield from walk(child, runs)

    return list(walk(item.file.root, False))


def edits_of(found, mutation, number):
    """A mistake behind its switch: the body of its function, or every use of its constant, as ranges and what
    they become."""
    item, begin, end = place(found, mutation)
    low, high = item.inside.start_byte, item.inside.end_byte
    mistaken = (item.file.bytes[low:begin] + mutation["to"].encode() + item.file.bytes[end:high]).decode()
    if item.is_function:
        return item.file, [(low, high, f"{{ if crate::mutant({number}) {mistaken} else ", " }")]
    head = f"({{ const MISTAKEN: {item.kind} = {mistaken}; if crate::mutant({number}) {{ MISTAKEN }} else {{ "
    places = uses(item)
    if not places:
        raise Unfit(f"no function of {item.file.name} uses {item.name}")
    return item.file, [(a, b, head, " } })") for a, b in places]


def rendered(file, edits):
    """The text of a file with all of its edits around what they are about."""
    before, after = {}, {}
    for begin, end, head, tail in edits:
        before.setdefault(begin, []).append((end, head))
        after.setdefault(end, []).append((begin, tail))
    text, at = "", 0
    for place in sorted({*before, *after}):
        text += file.bytes[at:place].decode()
        text += "".join(tail for _, tail in sorted(after.get(place, []), reverse=True))
        text += "".join(head for _, head in sorted(before.get(place, []), reverse=True))
        at = place
    return text + file.bytes[at:].decode()
