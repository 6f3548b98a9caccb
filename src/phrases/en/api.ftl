# The page that describes the interface for programs; what is in it is English in every language.

api-title = API for programs
api-about = This page lists the requests that programs can send, and the answers. For client generators:
api-subjects = Subjects
api-shapes = Data types
api-for = Allowed for
api-name = Name
api-body = Body
api-answer = Answer
api-problems = What may go wrong
