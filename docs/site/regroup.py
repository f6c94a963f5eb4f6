"""Changes Doxygen's XML so that Breathe shows each header with what is in it, and each name once."""
import pathlib
import re
import xml.etree.ElementTree as ET


def namespace_members(xml):
    """The functions, types and variables of namespace collide, by the header that they are in."""
    members = {}
    for section in ET.parse(xml / "namespacecollide.xml").iter("sectiondef"):
        for member in section:
            header = pathlib.Path(member.find("location").get("file")).name
            members.setdefault(header, {}).setdefault(section.get("kind"), []).append(member)
            member.find("name").text = "collide::" + member.find("name").text
            member.set("inline", "no")
    return members


def regroup_file(path, members):
    """Functions of the namespace are members of the file, and the namespace, which every header has, is not."""
    tree = ET.parse(path)
    file = tree.getroot().find("compounddef")
    names = {c.text for c in file.findall("innerclass")}
    for inner in file.findall("innernamespace"):
        file.remove(inner)
    for inner in file.findall("innerclass"):
        if inner.text.rpartition("::")[0] in names:  # it is shown within the other
            file.remove(inner)
    for kind, own in members.get(file.find("compoundname").text, {}).items():
        section = ET.Element("sectiondef", kind=kind)
        section.extend(own)
        file.insert(list(file).index(file.find("detaileddescription")) - 1, section)
    tree.write(path, encoding="UTF-8")


def inherited(member, base, own, name):
    """A member of a base in detail/ as if the class `own` had it, in its header; S is its own parameter."""
    member.set("id", member.get("id").replace(base, own.get("id")))
    for element in member.iter():
        element.text = re.sub(r"\bfloat\b", "S", element.text or "")
    member.find("name").text = name
    member.find("location").set("file", own.find("location").get("file"))  # else Breathe leaves it out
    return member


def regroup_class(path):
    """Friends are left out: operators that compare, and what the library itself calls. What a public class inherits of a public one is shown there. Nothing is shown of bases in detail/ but their members."""
    tree = ET.parse(path)
    own = tree.getroot().find("compounddef")
    own_id, own_name = own.get("id"), own.find("compoundname").text.rpartition("::")[2]
    for section in own.findall("sectiondef"):
        for friend in [m for m in section if m.get("kind") == "friend" or section.get("kind") == "friend"]:
            section.remove(friend)
        for member in list(section):
            base = member.get("id").rpartition("_1")[0]
            if base != own_id and "detail" in base:
                inherited(member, base, own, member.find("name").text)
            elif base != own_id:
                section.remove(member)
        if section.get("kind").startswith(("private", "protected")) or not section.findall("memberdef"):
            own.remove(section)
    for base in own.findall("basecompoundref"):
        if "detail::" not in base.text:
            continue
        own.remove(base)
        if base.get("refid") is None or (functions := own.find("sectiondef[@kind='public-func']")) is None:
            continue
        base_name = re.sub(r"<.*", "", base.text).rpartition("::")[2]
        constructors = ET.parse(path.parent / f"{base.get('refid')}.xml").findall(f".//memberdef[name='{base_name}']")
        for i, constructor in enumerate(constructors):
            functions.insert(i, inherited(constructor, base.get("refid"), own, own_name))
    for member in own.iter("memberdef"):
        member.set("inline", "no")
    tree.write(path, encoding="UTF-8")


def regroup(xml):
    members = namespace_members(xml)
    for path in [*xml.glob("*_8hpp.xml"), *xml.glob("*_8cuh.xml")]:
        regroup_file(path, members)
    for path in [*xml.glob("class*.xml"), *xml.glob("struct*.xml")]:
        regroup_class(path)
