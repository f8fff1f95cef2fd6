"""Places in the source by name: an item by its path, and within it what is to be changed by its kind; for mutations.py. Where a file
lies, how lines are broken, and what else stands in an item is nothing that a place depends on. Needs `pip install tree-sitter
tree-sitter-rust`.

An item is a function or a constant, named by as much of the end of its path as no other has: `Search::division`, `units::LENGTHS`,
`<Emd as Law>::respond` where a type has two of a name. What is changed there is one of

    code = "2.0"          a number, a name or an expression as it is written, without regard to spaces
    operator = "-"        an operator; `to` is another operator, or what takes the place of the whole: "{left}", "0.0 * {right}"
    call = "set_stream"   a call of that function or method; `to` may use {self}, {1}, {2}
    value = "weight"      what a variable, a field or a place in memory of that name is set to
    arm = "Retraction"    what an arm of a match leads to, whose pattern has that name in it
    without = "sort"      a statement that calls, or sets, what has that name; it is left out, without `to`

`to` is what takes its place, where {it} is what was there; `nth = "1 of 3"` says which, where an item has several: if there are
no longer so many, somebody has to look.
"""

import difflib
import re

from switches import ROOT, File, Unfit

KINDS = ("code", "operator", "call", "value", "arm", "without")
# What is written in an item that is compiled before it runs, or by a macro.
CLOSED = ("macro_invocation", "attribute_item", "line_comment", "block_comment")


class Item:
    """A function or a constant."""

    def __init__(self, path, name, file, node):
        self.path, self.name, self.file, self.node = path, name, file, node
        self.is_function = node.type == "function_item"
        self.inside = node.child_by_field_name("body" if self.is_function else "value")

    def place(self, node=None):
        return f"{self.name}:{(node or self.node).start_point[0] + 1}"


def name_of(node):
    return node.child_by_field_name("name").text.decode()


def type_of(node):
    """The name of a type without what it is generic over."""
    return re.sub(r"<.*", "", node.text.decode(), flags=re.S).split("::")[-1].lstrip("&").strip()


def items_of(name, file):
    """All items of a file, but for tests."""

    def walk(node, path):
        is_test = False
        for child in node.named_children:
            if child.type == "attribute_item":
                is_test |= "test" in child.text.decode()
                continue
            if not is_test:
                yield from of(child, path)
            is_test = is_test and child.type in CLOSED

    def of(node, path):
        if node.type in ("function_item", "const_item", "static_item"):
            own = [*path, name_of(node)]
            item = Item(own, name, file, node)
            if item.inside is not None:
                yield item
                yield from walk(item.inside, own)
        elif node.type == "impl_item":
            kind, trait = type_of(node.child_by_field_name("type")), node.child_by_field_name("trait")
            yield from walk(node.child_by_field_name("body"), [*path, (kind, type_of(trait) if trait else None)])
        elif node.type in ("mod_item", "trait_item"):
            if (body := node.child_by_field_name("body")) is not None:
                yield from walk(body, [*path, name_of(node)])
        elif node.type not in CLOSED:
            yield from walk(node, path)

    room = [part for part in name.removeprefix("src/").removesuffix(".rs").split("/") if part not in ("mod", "lib", "main")]
    return walk(file.root, room)


def is_of(part, wanted):
    """Whether a part of a path is called so."""
    if isinstance(part, tuple):
        return wanted in (part[0], f"<{part[0]} as {part[1]}>")
    return part == wanted


def written(path):
    parts = [(f"<{part[0]} as {part[1]}>" if part[1] else part[0]) if isinstance(part, tuple) else part for part in path]
    return "::".join(parts)


class Source:
    """All items of the source."""

    def __init__(self):
        names = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "src").rglob("*.rs"))
        self.files = {name: File(name) for name in names}
        self.items = [item for name, file in self.files.items() for item in items_of(name, file)]

    def item(self, wanted):
        parts = wanted.split("::")
        found = [item for item in self.items if len(item.path) >= len(parts) and all(map(is_of, item.path[-len(parts) :], parts))]
        if len(found) == 1:
            return found[0]
        if found:
            raise Unfit(f"`{wanted}` stands for {len(found)}: {', '.join(f'{written(item.path)} ({item.place()})' for item in found)}")
        names = {written(item.path): item for item in self.items}
        last = [name for name, item in names.items() if item.path[-1] == parts[-1]]
        kind = [name for name in names if len(parts) > 1 and parts[-2] in re.split(r"\W+", name)]
        close = difflib.get_close_matches(wanted, names, 3, 0.5)
        near = (last or kind or close)[:8]
        raise Unfit(f"there is no `{wanted}`" + "".join(f"\n    there is {name} ({names[name].place()})" for name in near))


def normal(text):
    """Code without regard to how its lines are broken."""
    text = re.sub(r"\s+", " ", text.strip())
    text = re.sub(r"(?<!\w) | (?!\w)", "", text)
    return re.sub(r",(?=[)\]}])", "", text)


def nodes(item):
    """All nodes inside an item that run, those of items inside of it too."""
    pending = [item.inside]
    while pending:
        node = pending.pop()
        if node.type not in CLOSED:
            yield node
            pending += reversed(node.children)


def callee(node):
    function = node.child_by_field_name("function")
    if function.type == "generic_function":
        function = function.child_by_field_name("function")
    return function


def last_name(text):
    return re.split(r"::|\.", normal(text))[-1].lstrip("*&")


def called(node, name):
    return node.type == "call_expression" and name in (normal(callee(node).text.decode()), last_name(callee(node).text.decode()))


def target(node):
    """What a node sets, and to what."""
    if node.type == "let_declaration":
        return node.child_by_field_name("pattern"), node.child_by_field_name("value")
    if node.type in ("assignment_expression", "compound_assignment_expr"):
        return node.child_by_field_name("left"), node.child_by_field_name("right")
    if node.type == "field_initializer":
        return node.child_by_field_name("field"), node.child_by_field_name("value")
    return None, None


def sets(node, name):
    left, value = target(node)
    return value is not None and name in (normal(left.text.decode()), last_name(left.text.decode()))


def stated(node, name):
    if node.type != "expression_statement":
        return sets(node, name) if node.type == "let_declaration" else False
    inside = node.named_children[0]
    while inside.type in ("try_expression", "await_expression"):
        inside = inside.named_children[0]
    return called(inside, name) or sets(inside, name)


def found(item, kind, wanted):
    """The places of a kind: of each the node that is replaced, and what it consists of."""
    for node in nodes(item):
        parts = {"it": node}
        if kind == "code" and normal(node.text.decode()) == normal(wanted):
            yield node, parts
        elif kind == "operator" and node.type in ("binary_expression", "compound_assignment_expr"):
            if node.child_by_field_name("operator").text.decode() == wanted:
                yield node, parts | {side: node.child_by_field_name(side) for side in ("left", "right")}
        elif kind == "call" and called(node, wanted):
            arguments = [child for child in node.child_by_field_name("arguments").named_children if child.type not in CLOSED]
            parts |= {str(i): argument for i, argument in enumerate(arguments, 1)}
            if callee(node).type == "field_expression":
                parts["self"] = callee(node).child_by_field_name("value")
            yield node, parts
        elif kind == "value" and sets(node, wanted):
            yield target(node)[1], {"it": target(node)[1]}
        elif kind == "arm" and node.type == "match_arm":
            if re.search(rf"\b{re.escape(wanted)}\b", normal(node.child_by_field_name("pattern").text.decode())):
                yield node.child_by_field_name("value"), {"it": node.child_by_field_name("value")}
        elif kind == "without" and stated(node, wanted):
            yield node, parts


def place(source, mutation):
    """The item of a mistake, the range of bytes that it changes, and what is there then."""
    kinds = [kind for kind in KINDS if kind in mutation]
    if len(kinds) != 1 or ("to" in mutation) == (kinds == ["without"]):
        raise Unfit(f"one of {', '.join(KINDS)} is needed, and `to` with all but `without`")
    (kind,), item = kinds, source.item(mutation["in"])
    # A name that is all of an expression is one place, not two.
    places = {(node.start_byte, node.end_byte): (node, parts) for node, parts in found(item, kind, mutation[kind])}
    places = [places[range_] for range_ in sorted(places)]
    nth, count = map(int, mutation.get("nth", "1 of 1").split(" of "))
    if len(places) != count:
        lines = ", ".join(str(node.start_point[0] + 1) for node, _ in places)
        times = f'{len(places)} times, in lines {lines}, not {count}: nth = "1 of {len(places)}"' if places else "not at all"
        raise Unfit(f"{kind} = {mutation[kind]!r} stands in {written(item.path)} ({item.place()}) {times}")
    node, parts = places[nth - 1]
    to = mutation.get("to", "")
    if kind == "operator" and re.fullmatch(r"[-+*/%<>=!&|^]+", to):
        to = f"{{left}} {to} {{right}}"
    try:
        text = re.sub(r"\{(it|self|left|right|\d)\}", lambda match: parts[match[1]].text.decode(), to)
    except KeyError as missing:
        raise Unfit(f"{kind} = {mutation[kind]!r} has no {{{missing.args[0]}}}") from None
    if normal(text) == normal(node.text.decode()):
        raise Unfit("changes nothing")
    return item, (node.start_byte, node.end_byte), text


def uses(item):
    """Where functions of its file use a constant."""
    name = item.path[-1]

    def walk(node, runs):
        if node.type in ("const_item", "static_item", "array_type", "macro_invocation", "const_block", "use_declaration"):
            return
        if node.type == "function_item":
            head = item.file.bytes[node.start_byte : node.child_by_field_name("name").start_byte]
            body = node.child_by_field_name("body")
            if body is not None:
                yield from walk(body, not re.search(rb"\bconst\b", head))
            return
        if node.type in ("scoped_identifier", "identifier") and runs:
            if node.text.decode() in (name, f"Self::{name}", f"self::{name}"):
                yield node.start_byte, node.end_byte
            return
        for child in node.named_children:
            yield from walk(child, runs)

    return list(walk(item.file.root, False))


def switched(source, mutation, number):
    """A mistake behind its switch, with the body of its function, or, if it is in a constant, at every use of that: its edits."""
    item, (begin, end), text = place(source, mutation)
    low, high = item.inside.start_byte, item.inside.end_byte
    mistaken = (item.file.bytes[low:begin] + text.encode() + item.file.bytes[end:high]).decode()
    if item.is_function:
        if re.search(rb"\bconst\b", item.file.bytes[item.node.start_byte : item.node.child_by_field_name("name").start_byte]):
            raise Unfit(f"{written(item.path)} is computed by the compiler")
        return [((low, high), lambda render: f"{{ if crate::mutant({number}) {mistaken} else {render(low, high)} }}")]
    kind = item.node.child_by_field_name("type").text.decode()
    head = f"{{ const MISTAKEN: {kind} = {mistaken}; if crate::mutant({number}) {{ MISTAKEN }} else"
    places = uses(item)
    if not places:
        raise Unfit(f"no function in {item.name} uses {written(item.path)}")
    return [((a, b), lambda render, a=a, b=b: f"({head} {{ {render(a, b)} }} }})") for a, b in places]
