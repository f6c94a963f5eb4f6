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


def regroup_class(path):
    """What a public class inherits of a public one is shown there; what of one in detail/, with its own parameter S."""
    tree = ET.parse(path)
    own = tree.getroot().find("compounddef")
    for section in own.findall("sectiondef"):
        for member in list(section):
            base = member.get("id").rpartition("_1")[0]
            if base == own.get("id"):
                continue
            if "detail" not in base:
                section.remove(member)
            for element in member.iter():
                element.text = re.sub(r"\bfloat\b", "S", element.text or "")
        if not section.findall("memberdef"):
            own.remove(section)
    tree.write(path, encoding="UTF-8")


def regroup(xml):
    members = namespace_members(xml)
    for path in [*xml.glob("*_8hpp.xml"), *xml.glob("*_8cuh.xml")]:
        regroup_file(path, members)
    for path in [*xml.glob("class*.xml"), *xml.glob("struct*.xml")]:
        regroup_class(path)
